# The part of the build that knows catkin: messages, the ros/ module, installation.

# control_msgs is not in Debian: where none is installed or in the workspace, the minimal one of this
# repository is built along. Decided once, for the next configuration finds the one built here.
find_package(catkin REQUIRED)
if(NOT DEFINED CIA402_OWN_CONTROL_MSGS)
  find_package(control_msgs QUIET)
  if(control_msgs_FOUND)
    set(own OFF)
  else()
    set(own ON)
  endif()
  set(CIA402_OWN_CONTROL_MSGS ${own} CACHE BOOL "Build the control_msgs of this repository")
endif()
if(CIA402_OWN_CONTROL_MSGS)
  add_subdirectory(control_msgs)
  set(control_msgs_DIR ${CATKIN_DEVEL_PREFIX}/share/control_msgs/cmake CACHE PATH "" FORCE)
endif()

set(cia402_message_packages
  actionlib_msgs control_msgs diagnostic_msgs geometry_msgs sensor_msgs std_msgs std_srvs
  trajectory_msgs)
set(cia402_ros_packages
  actionlib diagnostic_updater roscpp roslib tf2 tf2_ros ${cia402_message_packages})
find_package(catkin REQUIRED COMPONENTS message_generation ${cia402_ros_packages})

add_message_files(FILES
  AxisState.msg AxisStates.msg BusState.msg Emergency.msg LssIdentity.msg NodeState.msg)
add_service_files(FILES
  ErrorHistory.srv InjectFault.srv LssAssign.srv LssScan.srv LssSetBitTiming.srv Nmt.srv
  ReadObject.srv SaveDcf.srv SetMode.srv SetPosition.srv WriteObject.srv)
add_action_files(FILES Home.action)
generate_messages(DEPENDENCIES actionlib_msgs std_msgs)

# The modules with sources, for packages that use the library; in the linker's order.
foreach(module ros sim bus decode config motion drive canopen can common)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${module}/*.cpp)
  if(sources)
    list(APPEND cia402_libraries cia402_${module})
  endif()
endforeach()

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES ${cia402_libraries} yaml-cpp
  CATKIN_DEPENDS message_runtime ${cia402_ros_packages})

# The one module that knows ROS: src/ros/*.cpp.
function(cia402_ros_module)
  cia402_module(ros cia402_bus cia402_sim ${catkin_LIBRARIES})
  get_target_property(type cia402_ros TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    target_include_directories(cia402_ros SYSTEM PUBLIC ${CATKIN_DEVEL_PREFIX}/include
      ${catkin_INCLUDE_DIRS})
    add_dependencies(cia402_ros ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
  endif()
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
