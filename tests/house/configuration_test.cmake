# A shipped configuration loads, what a process prints it accepts again, and
# an unknown key is refused in one line.
#
#   cmake -DPROGRAM=<path> -DCONFIG=<yaml> -DSCRATCH=<folder>
#         -P configuration_test.cmake
cmake_minimum_required(VERSION 3.22)

function(expect_loads config)
  execute_process(COMMAND ${PROGRAM} --config ${config} --check-config
                  RESULT_VARIABLE status ERROR_VARIABLE errors
                  OUTPUT_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${config}: status ${status}: ${errors}")
  endif()
endfunction()

expect_loads(${CONFIG})

execute_process(COMMAND ${PROGRAM} --config ${CONFIG} --print-config
                RESULT_VARIABLE status OUTPUT_VARIABLE printed
                ERROR_VARIABLE errors)
if(NOT status EQUAL 0 OR printed STREQUAL "")
  message(FATAL_ERROR "--print-config: status ${status}: ${errors}")
endif()
get_filename_component(name ${CONFIG} NAME)
file(WRITE ${SCRATCH}/printed_${name} "${printed}")
expect_loads(${SCRATCH}/printed_${name})

execute_process(COMMAND ${PROGRAM} --config ${CONFIG} --set no_such_key=1
                        --check-config
                RESULT_VARIABLE status ERROR_VARIABLE errors
                OUTPUT_VARIABLE output)
if(NOT status EQUAL 2 OR NOT errors MATCHES "^[^\n]*no_such_key[^\n]*\n$")
  message(FATAL_ERROR "an unknown key: expected status 2 and one line that "
                      "names it, found ${status} and:\n${errors}")
endif()
