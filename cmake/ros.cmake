# The part of the build that knows catkin: messages, the ros/ module, installation.

# catkin runs on the Python that its packages are installed for; another one may come first in PATH.
# In a workspace catkin looks before it comes here: catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3.
function(cia402_find_python)
  foreach(python python3 /usr/bin/python3)
    execute_process(COMMAND ${python} -c "import catkin_pkg, em, sys; print(sys.executable)"
      OUTPUT_VARIABLE path RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT failed)
      set(PYTHON_EXECUTABLE ${path} CACHE FILEPATH "Python that catkin is installed for")
      return()
    endif()
  endforeach()
endfunction()
if(NOT PYTHON_EXECUTABLE)
  cia402_find_python()
endif()
find_package(catkin REQUIRED)

include(${CMAKE_CURRENT_LIST_DIR}/control_msgs.cmake)

set(cia402_message_packages
  actionlib_msgs control_msgs diagnostic_msgs dynamic_reconfigure geometry_msgs nav_msgs sensor_msgs
  std_msgs std_srvs trajectory_msgs)
set(cia402_ros_packages
  actionlib diagnostic_updater roscpp roslib tf2_ros ${cia402_message_packages})
find_package(catkin REQUIRED COMPONENTS message_generation ${cia402_ros_packages})

# Reads robot_description; ROS' own package of it is a wrapper that links a loader of plugins, too.
find_path(cia402_urdfdom_include urdf_parser/urdf_parser.h PATH_SUFFIXES urdfdom)
find_path(cia402_urdfdom_headers urdf_model/model.h PATH_SUFFIXES urdfdom_headers)
find_library(cia402_urdfdom urdfdom_model)
if(NOT cia402_urdfdom_include OR NOT cia402_urdfdom_headers OR NOT cia402_urdfdom)
  message(FATAL_ERROR "urdfdom was not found: install liburdfdom-dev and liburdfdom-headers-dev")
endif()

add_message_files(FILES
  AxisState.msg AxisStates.msg BusState.msg Emergency.msg LssIdentity.msg NodeState.msg)
add_service_files(FILES
  ArmTouchProbe.srv ErrorHistory.srv FactoryReset.srv InjectFault.srv LoadDcf.srv LssAssign.srv LssScan.srv
  LssSetBitTiming.srv
  Nmt.srv ReadObject.srv SaveDcf.srv SetBusParameters.srv SetDigitalOutputs.srv SetMode.srv
  SetPosition.srv WriteObject.srv)
add_action_files(FILES Home.action)
generate_messages(DEPENDENCIES actionlib_msgs std_msgs)

# The modules with sources, for packages that use the library; in the linker's order.
foreach(module ros driver sim bus decode config drive motion yaml canopen fieldbus can common)
  cia402_sources(${module} sources)
  if(sources)
    list(APPEND cia402_libraries cia402_${module})
  endif()
endforeach()

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES ${cia402_libraries} yaml-cpp ${cia402_urdfdom}
  CATKIN_DEPENDS message_runtime ${cia402_ros_packages})

# The one module that knows ROS: src/ros/*.cpp.
function(cia402_ros_module)
  cia402_module(ros cia402_driver cia402_bus cia402_sim ${cia402_urdfdom} ${catkin_LIBRARIES})
  get_target_property(type cia402_ros TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    target_include_directories(cia402_ros SYSTEM PUBLIC ${CATKIN_DEVEL_PREFIX}/include
      ${catkin_INCLUDE_DIRS} ${cia402_urdfdom_include} ${cia402_urdfdom_headers})
    add_dependencies(cia402_ros ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
  endif()
endfunction()

# Tests are built and run where catkin's testing is on: targets `tests` and `run_tests`.
if(NOT CATKIN_ENABLE_TESTING)
  set(CIA402_BUILD_TESTS OFF)
endif()

# Leaves a target to `tests`: `all` does not build it.
function(cia402_with_tests target)
  set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
  add_dependencies(tests ${target})
endfunction()

# Makes a test executable known to catkin. Those that need vcan0 are built, but not run.
function(cia402_catkin_test target)
  cia402_with_tests(${target})
  if(target MATCHES "_vcan$")
    return()
  endif()
  set(report gtest-${target}.xml)
  catkin_run_tests_target(gtest ${target} ${report} DEPENDENCIES ${target}
    COMMAND "$<TARGET_FILE:${target}> --gtest_output=xml:${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/${report}")
endfunction()

# The tests of the nodes with simulated drives inside. Those in test/vcan need vcan0, which
# scripts/with_vcan provides.
function(cia402_rostests)
  if(NOT CIA402_BUILD_TESTS)
    return()
  endif()
  find_package(rostest REQUIRED)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/ros/*.test)
  foreach(file ${files})
    add_rostest(${file} DEPENDENCIES cia402_run)
  endforeach()
endfunction()

# The tests of scripts and messages. Left to scripts/test are those that ask what scripts/demo has
# built (setup, convert_ros_canopen_loads) and that start user-mode Linux (with_vcan).
function(cia402_python_tests)
  if(NOT CIA402_BUILD_TESTS)
    return()
  endif()
  file(GLOB files CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/test/*_test.py ${PROJECT_SOURCE_DIR}/test/scripts/*_test.py)
  list(FILTER files EXCLUDE REGEX "/(setup|with_vcan|convert_ros_canopen_loads)_test.py$")
  foreach(file ${files})
    get_filename_component(name ${file} NAME_WE)
    set(report unittest-${name}.xml)
    set(reports ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME})
    catkin_run_tests_target(unittest ${name} ${report} DEPENDENCIES cia402_run
      COMMAND "${PYTHON_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/lib/run_tests.py --junit ${reports}/${report} unittest ${PROJECT_BINARY_DIR}/unittest ${file}")
  endforeach()
endfunction()

# What running the driver takes, without the tests: for a short first build.
function(cia402_run_target)
  add_custom_target(cia402_run DEPENDS ${cia402_executables} ${PROJECT_NAME}_generate_messages)
  if(CIA402_OWN_CONTROL_MSGS)
    add_dependencies(cia402_run control_msgs_generate_messages)
  endif()
endfunction()

# What a user of the installed package needs: programs, library, launch files and configuration.
function(cia402_ros_install)
  install(TARGETS ${cia402_executables} ${cia402_libraries}
    RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
    ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
  foreach(folder action config launch)
    if(EXISTS ${PROJECT_SOURCE_DIR}/${folder})
      install(DIRECTORY ${folder} DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
    endif()
  endforeach()
endfunction()
