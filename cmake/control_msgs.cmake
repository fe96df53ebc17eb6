# control_msgs is not in Debian: where none is installed or in the workspace, the minimal one of this
# repository is built along. Decided in each configuration, for one may have been installed since.

unset(CIA402_OWN_CONTROL_MSGS CACHE)  # where earlier versions kept the decision
set(cia402_control_msgs_built ${CATKIN_DEVEL_PREFIX}/share/control_msgs/cmake)
set(cia402_control_msgs_mark ${PROJECT_BINARY_DIR}/own_control_msgs)

if(TARGET control_msgs_generate_messages)  # of the workspace
  set(CIA402_OWN_CONTROL_MSGS OFF)
else()
  # One that is built here is found, too, when its setup.bash was sourced: it does not count.
  set(ignored ${CMAKE_IGNORE_PATH})
  list(APPEND CMAKE_IGNORE_PATH ${cia402_control_msgs_built})
  unset(control_msgs_DIR CACHE)
  find_package(control_msgs QUIET)
  set(CMAKE_IGNORE_PATH ${ignored})
  if(control_msgs_FOUND)
    set(CIA402_OWN_CONTROL_MSGS OFF)
    message(STATUS "control_msgs: the one in ${control_msgs_DIR}")
  else()
    set(CIA402_OWN_CONTROL_MSGS ON)
    message(STATUS "control_msgs: none installed, that of this repository is built")
  endif()
endif()

if(CIA402_OWN_CONTROL_MSGS)
  file(WRITE ${cia402_control_msgs_mark} "")
  add_subdirectory(control_msgs)
  set(control_msgs_DIR ${cia402_control_msgs_built} CACHE PATH "" FORCE)
elseif(EXISTS ${cia402_control_msgs_mark})
  # What was built here before would hide the installed one from whoever sources setup.bash.
  file(REMOVE_RECURSE
    ${CATKIN_DEVEL_PREFIX}/share/control_msgs ${CATKIN_DEVEL_PREFIX}/include/control_msgs
    ${CATKIN_DEVEL_PREFIX}/${PYTHON_INSTALL_DIR}/control_msgs
    ${CATKIN_DEVEL_PREFIX}/share/common-lisp/ros/control_msgs
    ${CATKIN_DEVEL_PREFIX}/etc/catkin/profile.d/30.control_msgs.sh
    ${cia402_control_msgs_mark})
endif()
