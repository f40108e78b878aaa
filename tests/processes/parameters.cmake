# The generated reference of all configuration keys cannot go stale.
get_property(_processes GLOBAL PROPERTY WAYMARK_PROCESSES)
list(SORT _processes)
set(_programs)
foreach(_process ${_processes})
  list(APPEND _programs $<TARGET_FILE:${_process}>)
endforeach()
string(REPLACE ";" "," _programs "${_programs}")
add_custom_target(update_parameters
  COMMAND ${CMAKE_COMMAND} -DPROGRAMS=${_programs}
          -DOUT=${CMAKE_SOURCE_DIR}/docs/parameters.md
          -P ${CMAKE_SOURCE_DIR}/docs/parameters.cmake
  DEPENDS ${_processes} VERBATIM)
add_test(NAME processes/parameters_test
  COMMAND ${CMAKE_COMMAND} -DPROGRAMS=${_programs}
          -DOUT=${CMAKE_CURRENT_BINARY_DIR}/parameters.md
          -DEXPECTED=${CMAKE_SOURCE_DIR}/docs/parameters.md
          -P ${CMAKE_SOURCE_DIR}/docs/parameters.cmake)
set_tests_properties(processes/parameters_test PROPERTIES LABELS unit
  TIMEOUT 60 ENVIRONMENT "LCM_DEFAULT_URL=memq://")
