# SPDX-License-Identifier: BSD-3-Clause
# Finds what the nodes use of ROS 1, as the target ROS1::ROS1. By header and library, not by ROS's own package files: those
# end the whole configuration where catkin is not installed. A sourced ROS is found through CMAKE_PREFIX_PATH.
include(FindPackageHandleStandardArgs)
set(_wanted "")
foreach(header ros/ros.h tf2_ros/transform_listener.h tf2_msgs/TFMessage.h geometry_msgs/PoseArray.h
    sensor_msgs/PointCloud2.h std_msgs/String.h std_srvs/Trigger.h trajectory_msgs/JointTrajectory.h
    visualization_msgs/MarkerArray.h)
  string(MAKE_C_IDENTIFIER "ROS1_${header}_DIR" name)
  find_path(${name} ${header})
  mark_as_advanced(${name})
  list(APPEND _wanted ${name})
  list(APPEND _includes ${${name}})
endforeach()
foreach(library tf2_ros tf2 actionlib roscpp xmlrpcpp rosconsole roscpp_serialization rostime)
  find_library(ROS1_${library}_LIBRARY ${library})
  mark_as_advanced(ROS1_${library}_LIBRARY)
  list(APPEND _wanted ROS1_${library}_LIBRARY)
  list(APPEND _libraries ${ROS1_${library}_LIBRARY})
endforeach()
find_package_handle_standard_args(ROS1 REQUIRED_VARS ${_wanted})
if(ROS1_FOUND AND NOT TARGET ROS1::ROS1)
  list(REMOVE_DUPLICATES _includes)
  add_library(ROS1::ROS1 INTERFACE IMPORTED)
  set_target_properties(ROS1::ROS1 PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${_includes}"
    INTERFACE_INCLUDE_DIRECTORIES "${_includes}" INTERFACE_LINK_LIBRARIES "${_libraries}")
endif()
