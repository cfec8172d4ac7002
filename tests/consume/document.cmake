# A document must hold what the installed command prints.
execute_process(COMMAND ${prefix}/bin/grainvdb ${command} --markdown OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
file(READ ${document} text)
string(FIND "${text}" "${printed}" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${document} is out of date: replace its table by the output of `grainvdb ${command} --markdown`.")
endif()
