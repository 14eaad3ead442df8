# SPDX-License-Identifier: BSD-3-Clause
"""The node on a robot that publishes joint_states, depth images (or points) and the hand-eye transform tool0 to the optical frame.

    ros2 launch agrisee_ros2 scan.launch.py workcell:=/path/cell.yaml params:=/path/params.yaml

Remap what your drivers name otherwise: color_image:=/camera/aligned/image_raw and so on.
"""
import os

import yaml
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessStart
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition

ARGUMENTS = {
    'workcell': (None, 'scene file; of it robot, sensor, scan_volume and keep_out are used'),
    'params': ('', "YAML file with parameters of the pipeline, as of agrisee scan --params"),
    'seed': ('', 'of the planner; if it is not given, that of params'),
    'autostart': ('', 'true: start without the service; if it is not given, as in params'),
    'color': ('', 'true: take colors from color_image; if it is not given, as in params'),
    'labels': ('', "true: take a detector's label images from labels_image; if it is not given, as in params"),
    'depth_image': ('/depth/image', 'topic'),
    'camera_info': ('/depth/camera_info', 'topic'),
    'color_image': ('/color/image', 'topic; registered to the depth image'),
    'labels_image': ('/labels/image', 'topic; registered to the depth image'),
    'points': ('/points', 'topic; instead of depth images'),
    'joint_goal': ('/agrisee/joint_goal', 'topic that moves the arm'),
    'rviz': ('false', 'show it in RViz'),
}


def is_true(name, text):
    if text.lower() not in ('true', '1', 'false', '0'):
        raise ValueError(f'{name} has to be true or false, got {text}')
    return text.lower() in ('true', '1')


def nodes(context):
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    parameters = {}
    if value['params']:
        with open(value['params'], encoding='utf-8') as file:
            parameters = yaml.safe_load(file) or {}
    parameters['workcell'] = os.path.abspath(value['workcell'])
    if value['seed']:
        parameters['seed'] = int(value['seed'])
    if value['autostart']:
        parameters['autostart'] = is_true('autostart', value['autostart'])
    for name in ('color', 'labels'):
        if value[name]:
            parameters.setdefault('channels', {})[name] = is_true(name, value[name])
    scan = LifecycleNode(
        package='agrisee_ros2', executable='scan_node', name='agrisee', namespace='', output='screen', parameters=[parameters],
        remappings=[('depth/image', value['depth_image']), ('depth/camera_info', value['camera_info']),
                    ('color/image', value['color_image']), ('labels/image', value['labels_image']),
                    ('points', value['points']), ('~/joint_goal', value['joint_goal'])])

    def change(transition):
        return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(scan), transition_id=transition))

    # Configured once it runs, activated once it is configured. A node with bad parameters says so and stays as it is.
    configure = RegisterEventHandler(OnProcessStart(target_action=scan, on_start=[change(Transition.TRANSITION_CONFIGURE)]))
    activate = RegisterEventHandler(OnStateTransition(
        target_lifecycle_node=scan, start_state='configuring', goal_state='inactive',
        entities=[change(Transition.TRANSITION_ACTIVATE)]))
    rviz = Node(package='rviz2', executable='rviz2', condition=IfCondition(LaunchConfiguration('rviz')),
                arguments=['-d', os.path.join(get_package_share_directory('agrisee_ros2'), 'rviz', 'agrisee.rviz')])
    return [configure, activate, scan, rviz]


def generate_launch_description():
    return LaunchDescription(
        [DeclareLaunchArgument(name, default_value=default, description=text) for name, (default, text) in ARGUMENTS.items()]
        + [OpaqueFunction(function=nodes)])
