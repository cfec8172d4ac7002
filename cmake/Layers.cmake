# grainvdb_layer(NAME SOURCES file... [DISPATCHED file...] [LINKS target...])
# One folder of src as an object library: it sees the public headers and those of src, and fails to build when it needs
# something outside what it declares. DISPATCHED files are compiled once for each instruction set, by including themselves.
function(grainvdb_layer name)
  cmake_parse_arguments(L "" "" "SOURCES;DISPATCHED;LINKS" ${ARGN})
  if(NOT L_SOURCES)
    add_library(grainvdb_${name} INTERFACE)
    return()
  endif()
  add_library(grainvdb_${name} OBJECT ${L_SOURCES} ${L_DISPATCHED})
  set_source_files_properties(${L_DISPATCHED} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_include_directories(grainvdb_${name} PUBLIC
    ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(grainvdb_${name} PUBLIC ${L_LINKS})
  grainvdb_compile_options(grainvdb_${name})
  set(GRAINVDB_LAYERS ${GRAINVDB_LAYERS} ${name} PARENT_SCOPE)
endfunction()

function(grainvdb_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast)
  # GCC takes a file that a unity source includes for a header, in which a type with unnamed members would be a fault.
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(GRAINVDB_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

if(GRAINVDB_SANITIZE)
  add_compile_options(-fsanitize=${GRAINVDB_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GRAINVDB_SANITIZE})
endif()
