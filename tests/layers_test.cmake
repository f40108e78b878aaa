# Greps the sources for violations of the layers (STYLE: what may include
# what, no clock, no random numbers, no output in libraries).
#
#   cmake -DROOT=<tree> -P layers_test.cmake
#   cmake -DSELF_TEST=<scratch folder> -P layers_test.cmake
#
# The first prints one line for each violation and fails if there is any. The
# second plants violations one by one and fails if any is not caught.
cmake_minimum_required(VERSION 3.22)

# ---- the rules -------------------------------------------------------------

# Folders (or rooms) whose headers a room may include, besides its own; one
# regular expression each.
set(may_include_estimation "^estimation/")
set(may_include_planner "^(planner|estimation)/")
set(may_include_drivers "^(drivers/|estimation/(base|geometry|camera)/)")
set(may_include_processes "^(processes|estimation|planner|drivers|procman)/")
set(may_include_logs
    "^(logs|estimation|planner|procman|processes/(support|convert))/")
set(may_include_procman "^(procman|estimation/base|processes/support)/")
set(rooms estimation planner drivers processes logs procman)
set(pure_rooms estimation planner drivers)

# Inside estimation a folder includes its own rank or lower ones.
set(ranks_base 0)
set(ranks_geometry 1)
set(ranks_camera 2)
foreach(folder lines features floor)
  set(ranks_${folder} 3)
endforeach()
foreach(folder two_view corridor filter batch places markers image_volume)
  set(ranks_${folder} 4)
endforeach()

# System headers that pure libraries never include.
set(middleware "^<(lcm|waymark|bot_core|bot_procman|procman_lcm|spdlog|yaml-cpp|CLI|libwebsockets)[/.]")
set(screen_headers "^<(opencv2/highgui|QtWidgets|gtk|ncurses)")
# Headers that one file alone may include.
set(single_file_headers "embree3/" "assimp/" "sqlite3.h" "termios.h")

set(clock_pattern
    "(system|steady|high_resolution)_clock|gettimeofday|clock_gettime|[^A-Za-z0-9_]time\\((NULL|nullptr|0)\\)|sleep_for|usleep")
set(random_pattern "random_device|[^A-Za-z0-9_]s?rand\\(")
set(thread_pattern "std::(jthread|thread|async)[^A-Za-z0-9_]|#include <(thread|future)>")
set(output_pattern "std::(cout|cerr|clog)|[^A-Za-z0-9_n](f?printf|puts)\\(|#include <iostream>")
set(environment_pattern "getenv\\(")

# ---- the check -------------------------------------------------------------

set_property(GLOBAL PROPERTY violations "")

function(report file text)
  set_property(GLOBAL APPEND PROPERTY violations "${file}: ${text}")
endfunction()

function(check_include file room header)
  if(NOT header MATCHES "^\"")
    if(room IN_LIST pure_rooms AND header MATCHES "${middleware}")
      report(${file} "a pure library includes ${header}")
    endif()
    if(room IN_LIST pure_rooms AND header MATCHES "${screen_headers}")
      report(${file} "a pure library includes the screen's ${header}")
    endif()
    return()
  endif()
  string(REPLACE "\"" "" header ${header})
  if(header MATCHES "^(lcm|waymark)/")
    report(${file} "includes ${header} in quotes, not as a system header")
    return()
  endif()
  if(NOT header MATCHES "/")
    report(${file} "includes ${header} without its path from the root")
    return()
  endif()
  if(NOT header MATCHES "${may_include_${room}}")
    report(${file} "${room}/ may not include ${header}")
    return()
  endif()
  if(room STREQUAL "estimation" AND header MATCHES "^estimation/([a-z_]+)/")
    set(their_folder ${CMAKE_MATCH_1})
    string(REGEX MATCH "^estimation/([a-z_]+)/" _ ${file})
    set(our_folder ${CMAKE_MATCH_1})
    if(NOT DEFINED ranks_${our_folder})
      report(${file} "estimation/${our_folder} has no rank in the layers test")
    elseif(NOT DEFINED ranks_${their_folder}
           OR ranks_${their_folder} GREATER ranks_${our_folder})
      report(${file} "estimation/${our_folder} may not include ${header}")
    elseif(NOT our_folder STREQUAL their_folder)
      set_property(GLOBAL PROPERTY edge_${our_folder}_${their_folder} ${file})
      get_property(back GLOBAL PROPERTY edge_${their_folder}_${our_folder})
      if(back)
        report(${file} "includes ${header}, and ${back} the other way round")
      endif()
    endif()
  endif()
endfunction()

function(check_words file room text)
  # Processes get their time from messages; the bus and tools wait on clocks.
  if(room IN_LIST pure_rooms
     OR (room STREQUAL "processes"
         AND NOT file MATCHES "^processes/(support|tools)/"))
    foreach(kind clock random)
      if(text MATCHES "${${kind}_pattern}")
        report(${file} "uses a ${kind}: '${CMAKE_MATCH_0}'")
      endif()
    endforeach()
  endif()
  if(room IN_LIST pure_rooms)
    foreach(kind thread output environment)
      # Device drivers own the threads of their devices.
      if(text MATCHES "${${kind}_pattern}"
         AND NOT (kind STREQUAL "thread" AND room STREQUAL "drivers"))
        report(${file} "a pure library uses ${kind}: '${CMAKE_MATCH_0}'")
      endif()
    endforeach()
  endif()
endfunction()

function(check_source root file)
  string(REGEX MATCH "^[a-z]+" room ${file})
  file(READ ${root}/${file} text)
  # Comments may name anything; so may the strings of messages to people.
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX MATCHALL "#include +[<\"][A-Za-z0-9_./+-]+[>\"]" includes
         "${text}")
  foreach(include ${includes})
    string(REGEX REPLACE "^#include +" "" header ${include})
    check_include(${file} ${room} ${header})
    foreach(single ${single_file_headers})
      # The keyboard of a person is no serial port of a device.
      if(single STREQUAL "termios.h"
         AND file STREQUAL "processes/teleop/terminal.cc")
        continue()
      endif()
      if(header MATCHES "^<${single}")
        get_property(other GLOBAL PROPERTY "single_${single}")
        if(other AND NOT other STREQUAL file)
          report(${file} "includes ${header}, which is ${other}'s alone")
        endif()
        set_property(GLOBAL PROPERTY "single_${single}" ${file})
      endif()
    endforeach()
  endforeach()
  check_words(${file} ${room} "${text}")
endfunction()

function(check_build_file root file)
  file(READ ${root}/${file} text)
  string(REGEX REPLACE "#[^\n]*" "" text "${text}")
  if(text MATCHES "-ffast-math")
    report(${file} "uses -ffast-math")
  endif()
  if(file MATCHES "^(estimation|planner|drivers)/" AND text MATCHES
     "waymark_(support|lcmtypes|lcm_interface|convert|log_[a-z]+|[a-z_]+_process)")
    report(${file} "a pure library links ${CMAKE_MATCH_0}")
  endif()
endfunction()

function(check_tree root)
  set(num_sources 0)
  foreach(room ${rooms})
    file(GLOB_RECURSE sources RELATIVE ${root}
         ${root}/${room}/*.h ${root}/${room}/*.cc)
    foreach(file ${sources})
      check_source(${root} ${file})
      math(EXPR num_sources "${num_sources} + 1")
    endforeach()
    file(GLOB_RECURSE build_files RELATIVE ${root}
         ${root}/${room}/CMakeLists.txt)
    foreach(file ${build_files})
      check_build_file(${root} ${file})
    endforeach()
  endforeach()
  if(num_sources EQUAL 0)
    message(FATAL_ERROR "layers: no sources under ${root}")
  endif()
  get_property(violations GLOBAL PROPERTY violations)
  list(LENGTH violations num_violations)
  foreach(violation ${violations})
    message("layers: ${violation}")
  endforeach()
  if(num_violations GREATER 0)
    message(FATAL_ERROR "layers: ${num_violations} violations")
  endif()
  message("layers: ${num_sources} sources, no violation")
endfunction()

# ---- the self-test ---------------------------------------------------------

# Plants TEXT as FILE beside a clean file (and another, if given) and expects
# the check to name it.
function(expect_caught file text)
  file(REMOVE_RECURSE ${SELF_TEST})
  file(WRITE ${SELF_TEST}/estimation/base/clean.h "#include <vector>\n")
  if(ARGC EQUAL 4)
    file(WRITE ${SELF_TEST}/${ARGV2} "${ARGV3}\n")
  endif()
  file(WRITE ${SELF_TEST}/${file} "${text}\n")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -DROOT=${SELF_TEST} -P ${CMAKE_SCRIPT_MODE_FILE}
    RESULT_VARIABLE status ERROR_VARIABLE output OUTPUT_VARIABLE output)
  if(status EQUAL 0 OR NOT output MATCHES "layers: ${file}: ")
    message(SEND_ERROR "not caught in ${file}: ${text}\n${output}")
  endif()
endfunction()

function(expect_clean file text)
  file(REMOVE_RECURSE ${SELF_TEST})
  file(WRITE ${SELF_TEST}/${file} "${text}\n")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -DROOT=${SELF_TEST} -P ${CMAKE_SCRIPT_MODE_FILE}
    RESULT_VARIABLE status ERROR_VARIABLE output OUTPUT_VARIABLE output)
  if(NOT status EQUAL 0)
    message(SEND_ERROR "wrongly refused ${file}: ${text}\n${output}")
  endif()
endfunction()

function(self_test)
  expect_caught(estimation/filter/a.h "#include <lcm/lcm-cpp.hpp>")
  expect_caught(estimation/filter/a.cc "#include <waymark/pose_t.hpp>")
  expect_caught(planner/map/a.cc "#include <bot_core/image_t.hpp>")
  expect_caught(drivers/video/a.cc "#include \"processes/support/bus.h\"")
  expect_caught(drivers/video/a.cc "#include \"estimation/filter/ekf.h\"")
  expect_caught(estimation/filter/a.cc "#include \"planner/map/graph.h\"")
  expect_caught(planner/map/a.cc "#include \"drivers/wheels/base.h\"")
  expect_caught(processes/pose_filter/a.cc "#include \"logs/report/html.h\"")
  expect_caught(logs/report/a.cc "#include \"tests/support/scene.h\"")
  expect_caught(logs/report/a.cc "#include \"drivers/simulator/world.h\"")
  expect_caught(procman/deputy/a.cc "#include \"planner/map/graph.h\"")
  expect_caught(estimation/base/a.h "#include \"estimation/geometry/pose2.h\"")
  expect_caught(estimation/camera/a.h "#include \"estimation/filter/ekf.h\"")
  expect_caught(estimation/magic/a.h "#include \"estimation/base/time.h\"")
  expect_caught(estimation/filter/a.cc "#include \"ekf.h\"")
  expect_caught(estimation/filter/a.cc "auto t = std::chrono::steady_clock::now()")
  expect_caught(processes/pose_filter/a.cc "x = std::chrono::system_clock::now()")
  expect_caught(planner/map/a.cc "const int x = std::rand()")
  expect_caught(planner/map/a.cc "std::random_device seed")
  expect_caught(planner/map/a.cc "std::thread worker")
  expect_caught(estimation/lines/a.cc "std::cout << 1")
  expect_caught(estimation/lines/a.cc "  std::printf(x)")
  expect_caught(estimation/lines/a.cc "std::getenv(name)")
  expect_caught(estimation/lines/a.cc "#include <opencv2/highgui.hpp>")
  expect_caught(estimation/filter/CMakeLists.txt "PUBLIC waymark_lcmtypes")
  expect_caught(estimation/filter/CMakeLists.txt "add_compile_options(-ffast-math)")
  expect_caught(estimation/filter/a.h "#include \"estimation/batch/b.h\""
                estimation/batch/b.h "#include \"estimation/filter/a.h\"")
  expect_caught(planner/map/b.cc "#include <sqlite3.h>"
                planner/map/a.cc "#include <sqlite3.h>")

  expect_clean(estimation/filter/a.cc "#include \"estimation/geometry/pose2.h\"")
  expect_clean(estimation/filter/a.cc "// as steady_clock and std::cout do")
  expect_clean(estimation/filter/a.cc "std::snprintf(x) WallTime(0) operand(1)")
  expect_clean(processes/support/a.cc "std::chrono::steady_clock::now()")
  expect_clean(drivers/wheels/a.cc "#include \"estimation/geometry/pose2.h\"")
  expect_clean(logs/report/a.cc "#include \"processes/support/log_file.h\"")
  file(REMOVE_RECURSE ${SELF_TEST})
endfunction()

if(SELF_TEST)
  self_test()
else()
  check_tree(${ROOT})
endif()
