# Writes the reference of all configuration keys from the processes themselves,
# or compares it with the committed one:
#   cmake -DPROGRAMS=a,b -DOUT=FILE [-DEXPECTED=FILE] -P docs/parameters.cmake
string(REPLACE "," ";" _programs "${PROGRAMS}")
string(CONCAT _text
  "# Configuration of every process\n\n"
  "Made from the programs (`cmake --build build --target update_parameters`); a\n"
  "test compares it. Each process loads `--config FILE`, else the YAML file\n"
  "shipped for it, over these defaults; `--set gate.key=value` comes last.\n"
  "`--print-config` shows the result. Unknown, repeated, ill-typed or\n"
  "out-of-range keys are refused with file and line.\n")
foreach(_program ${_programs})
  get_filename_component(_name ${_program} NAME)
  execute_process(COMMAND ${_program} --describe-config
    OUTPUT_VARIABLE _table RESULT_VARIABLE _result)
  if(_result)
    message(FATAL_ERROR "${_program} --describe-config failed: ${_result}")
  endif()
  string(APPEND _text "\n## ${_name}\n\n${_table}")
endforeach()
file(WRITE ${OUT} "${_text}")
if(EXPECTED)
  # Compared as files: reading into a variable would alter brackets.
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${OUT} ${EXPECTED}
    RESULT_VARIABLE _differs)
  if(_differs)
    execute_process(COMMAND diff -u ${EXPECTED} ${OUT})
    message(FATAL_ERROR "${EXPECTED} is not what the processes say now: run "
      "cmake --build build --target update_parameters, and commit it")
  endif()
endif()
