# waymark_add_lcmtypes(<target> FILES <file.lcm>...)
#
# C++ headers of message definitions by lcm-gen, as <package>/<type>.hpp, and
# an interface library that gives them. Needs lcm-gen and the decode guard,
# which Waymark::lcmtypes carries. The headers of the library are listed in its
# property WAYMARK_HEADERS.
set(WAYMARK_LCM_GUARD ${CMAKE_CURRENT_LIST_DIR}/guard_decoders.cmake)
find_program(LCM_GEN lcm-gen REQUIRED)

function(waymark_add_lcmtypes name)
  cmake_parse_arguments(A "" "OUTPUT" "FILES" ${ARGN})
  if(NOT A_OUTPUT)
    set(A_OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name})
  endif()
  set(_headers)
  foreach(_file ${A_FILES})
    get_filename_component(_file ${_file} ABSOLUTE)
    get_filename_component(_type ${_file} NAME_WE)
    file(READ ${_file} _text)
    if(NOT _text MATCHES "package ([A-Za-z0-9_]+)[;]")
      message(FATAL_ERROR "${_file}: no line 'package <name>;'")
    endif()
    set(_header ${A_OUTPUT}/${CMAKE_MATCH_1}/${_type}.hpp)
    add_custom_command(OUTPUT ${_header}
      COMMAND ${LCM_GEN} --cpp --cpp-std=c++11 --cpp-hpath ${A_OUTPUT} ${_file}
      COMMAND ${CMAKE_COMMAND} -DHEADER=${_header} -P ${WAYMARK_LCM_GUARD}
      DEPENDS ${_file} ${WAYMARK_LCM_GUARD} VERBATIM)
    list(APPEND _headers ${_header})
  endforeach()
  add_custom_target(${name}_headers DEPENDS ${_headers})
  add_library(${name} INTERFACE)
  add_dependencies(${name} ${name}_headers)
  target_include_directories(${name} SYSTEM INTERFACE
    $<BUILD_INTERFACE:${A_OUTPUT}>)
  if(TARGET Waymark::lcmtypes)
    target_link_libraries(${name} INTERFACE Waymark::lcmtypes)
  endif()
  set_target_properties(${name} PROPERTIES WAYMARK_HEADERS "${_headers}")
endfunction()
