# A program explains itself and refuses what it does not know.
#
#   cmake -DPROGRAM=<path> -P help_test.cmake
cmake_minimum_required(VERSION 3.22)

execute_process(COMMAND ${PROGRAM} --help RESULT_VARIABLE status
                OUTPUT_VARIABLE help ERROR_VARIABLE errors)
string(LENGTH "${help}" length)
# The shortest useful help names the program, its arguments and --help.
if(NOT status EQUAL 0 OR length LESS 60)
  message(FATAL_ERROR "--help: status ${status}, ${length} characters on "
                      "stdout, stderr: ${errors}")
endif()

execute_process(COMMAND ${PROGRAM} --no-such-flag RESULT_VARIABLE status
                OUTPUT_VARIABLE output ERROR_VARIABLE errors)
if(NOT status EQUAL 2 OR NOT errors MATCHES "^[^\n]+\n$")
  message(FATAL_ERROR "an unknown flag: expected status 2 and one line on "
                      "stderr, found ${status} and:\n${errors}")
endif()
