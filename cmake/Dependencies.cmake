# OpenVDB ships a find module instead of a package configuration.
find_path(OPENVDB_MODULE_DIR FindOpenVDB.cmake
  PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/lib/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB
  REQUIRED)
list(APPEND CMAKE_MODULE_PATH ${OPENVDB_MODULE_DIR})

find_package(TBB REQUIRED)
block()  # FindOpenVDB sets BUILD_SHARED_LIBS for whoever calls it; here the user chooses
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)  # it also reports Python modules of Imath that nobody needs
  find_package(OpenVDB REQUIRED)
endblock()
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(HDF5 REQUIRED COMPONENTS C HL)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(FastFloat REQUIRED)
find_package(hwy 1.0 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(zstd REQUIRED)
# voro++ ships neither a package configuration nor a find module.
find_path(VORO_INCLUDE_DIR voro++/voro++.hh REQUIRED)
find_library(VORO_LIBRARY voro++ REQUIRED)
add_library(Voro::voro++ UNKNOWN IMPORTED)
set_target_properties(Voro::voro++ PROPERTIES
  IMPORTED_LOCATION ${VORO_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${VORO_INCLUDE_DIR})

# What the library links but its users need not know.
set(GRAINVDB_PRIVATE_DEPENDENCIES
  $<BUILD_INTERFACE:Eigen3::Eigen> $<BUILD_INTERFACE:nlohmann_json::nlohmann_json> $<BUILD_INTERFACE:FastFloat::fast_float>
  hdf5::hdf5_hl hdf5::hdf5 yaml-cpp ZLIB::ZLIB zstd::libzstd_shared hwy::hwy Voro::voro++)
