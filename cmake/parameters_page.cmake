# Writes docs/parameters.md as the program prints it: cmake -DPROGRAM=... -DOUTPUT=... -P parameters_page.cmake
execute_process(COMMAND ${PROGRAM} schema --markdown OUTPUT_VARIABLE page COMMAND_ERROR_IS_FATAL ANY)
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT page STREQUAL old)
  file(WRITE ${OUTPUT} "${page}")
endif()
