# SPDX-License-Identifier: BSD-3-Clause
"""The files beside the ROS nodes: ROS 2's launch file runs against recorders in place of ROS's launch packages, the layout of RViz shows
topics that are published, CMake and package.xml name the same packages, and ROS 1's demonstration has all arguments of its simulation.

    files_test.py EXAMPLES    # the project's folder examples; 77 where PyYAML is missing
"""
import importlib.util
import pathlib
import re
import sys
import tempfile
import types
import xml.etree.ElementTree

try:
    import yaml
except ImportError:
    print('SKIPPED: python3-yaml is not installed')
    sys.exit(77)

EXAMPLES = pathlib.Path(sys.argv[1])
ROS2 = EXAMPLES / 'ros2'


class Recorder:
    """Stands for any class of the launch packages; keeps what it was made with."""

    def __init__(self, *args, **kwargs):
        self.args, self.kwargs = args, kwargs


class LaunchConfiguration(Recorder):
    def perform(self, context):
        return context[self.args[0]]


def stand_ins():
    """Modules with the names that the launch file imports."""
    names = {
        'launch': ['LaunchDescription'],
        'launch.actions': ['DeclareLaunchArgument', 'EmitEvent', 'OpaqueFunction', 'RegisterEventHandler'],
        'launch.conditions': ['IfCondition'],
        'launch.event_handlers': ['OnProcessStart'],
        'launch.events': ['matches_action'],
        'launch.substitutions': [],
        'launch_ros': [],
        'launch_ros.actions': ['LifecycleNode', 'Node'],
        'launch_ros.event_handlers': ['OnStateTransition'],
        'launch_ros.events': [],
        'launch_ros.events.lifecycle': ['ChangeState'],
        'lifecycle_msgs': [],
        'lifecycle_msgs.msg': [],
        'ament_index_python': [],
        'ament_index_python.packages': [],
    }
    for module, classes in names.items():
        sys.modules[module] = types.ModuleType(module)
        for name in classes:
            setattr(sys.modules[module], name, type(name, (Recorder,), {}))
    sys.modules['launch.substitutions'].LaunchConfiguration = LaunchConfiguration
    sys.modules['ament_index_python.packages'].get_package_share_directory = lambda package: f'/share/{package}'
    sys.modules['lifecycle_msgs.msg'].Transition = types.SimpleNamespace(TRANSITION_CONFIGURE=1, TRANSITION_ACTIVATE=3)


def launched(**arguments):
    """The actions that the launch file asks for, by the names of their classes."""
    spec = importlib.util.spec_from_file_location('scan_launch', ROS2 / 'launch/scan.launch.py')
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    entries = module.generate_launch_description().args[0]
    context = {e.args[0]: e.kwargs['default_value'] for e in entries if type(e).__name__ == 'DeclareLaunchArgument'}
    assert context['workcell'] is None, 'the workcell has to be asked for'
    assert set(arguments) <= set(context), arguments
    context.update(arguments)
    opaque = [e for e in entries if type(e).__name__ == 'OpaqueFunction']
    assert len(opaque) == 1
    return opaque[0].kwargs['function'](context)


def test_launch():
    stand_ins()
    with tempfile.TemporaryDirectory() as folder:
        params = pathlib.Path(folder, 'params.yaml')
        params.write_text('max_views: 4\nsplit: {bodies: {radius_min: 0.01}}\nchannels: {score: 0.8, color: true, labels: false}\n', encoding='utf-8')
        actions = launched(workcell='/cell.yaml', params=str(params), labels='1', labels_image='/yolo/labels', seed='7')
    node = next(a for a in actions if type(a).__name__ == 'LifecycleNode').kwargs
    assert node['parameters'] == [{  # an argument that is not given leaves what the file says
        'max_views': 4, 'split': {'bodies': {'radius_min': 0.01}}, 'channels': {'score': 0.8, 'color': True, 'labels': True},
        'workcell': '/cell.yaml', 'seed': 7}], node['parameters']
    for text, wanted in (('True', True), ('1', True), ('false', False), ('0', False)):
        actions = launched(workcell='/cell.yaml', autostart=text)
        node_parameters = next(a for a in actions if type(a).__name__ == 'LifecycleNode').kwargs['parameters']
        assert node_parameters == [{'workcell': '/cell.yaml', 'autostart': wanted}], node_parameters
    try:
        launched(workcell='/cell.yaml', color='yes')
        raise AssertionError('color:=yes was taken')
    except ValueError as error:
        assert str(error) == 'color has to be true or false, got yes'
    remapped = dict(node['remappings'])
    assert remapped['labels/image'] == '/yolo/labels'
    source = (ROS2 / 'scan_node.cpp').read_text(encoding='utf-8')
    for topic in remapped:
        assert f'"{topic.replace("~/", "")}"' in source + (EXAMPLES / 'ros_common/node_outputs.hpp').read_text(encoding='utf-8'), topic
    cmake = (ROS2 / 'CMakeLists.txt').read_text(encoding='utf-8')
    assert f'EXECUTABLE {node["executable"]})' in cmake and f'project({node["package"]} ' in cmake
    assert f'LifecycleNode("{node["name"]}", options)' in source
    events = [a.args[0] for a in actions if type(a).__name__ == 'RegisterEventHandler']
    assert [type(e).__name__ for e in events] == ['OnProcessStart', 'OnStateTransition']
    rviz = next(a for a in actions if type(a).__name__ == 'Node').kwargs['arguments'][1]
    assert (ROS2 / pathlib.Path(rviz).relative_to('/share/agrisee_ros2')).exists(), rviz


def test_rviz():
    outputs = (EXAMPLES / 'ros_common/node_outputs.hpp').read_text(encoding='utf-8')
    latched = re.findall(r'f\("(\w+)", typename Ros::\w+\(\), true\);', outputs)
    assert len(latched) == 9, latched
    displays = yaml.safe_load((ROS2 / 'rviz/agrisee.rviz').read_text(encoding='utf-8'))['Visualization Manager']['Displays']
    shown = [d['Topic'] for d in displays if 'Topic' in d]
    assert len(shown) == 4
    for topic in shown:
        assert topic['Value'].replace('/agrisee/', '') in latched, topic
        assert topic['Durability Policy'] == 'Transient Local' and topic['Reliability Policy'] == 'Reliable', topic


def test_packages():
    package = xml.etree.ElementTree.parse(ROS2 / 'package.xml').getroot()
    depends = {e.text for e in package.iter('depend')} - {'agrisee'}
    cmake = (ROS2 / 'CMakeLists.txt').read_text(encoding='utf-8')
    assert depends == set(re.search(r'foreach\(package ([^)]*)\)', cmake).group(1).split()), depends
    included = set(re.findall(r'#include <(\w+)/', ''.join(p.read_text(encoding='utf-8') for p in ROS2.glob('*.?pp'))))
    assert included <= depends, included - depends


def test_demo():
    launch = xml.etree.ElementTree.parse(EXAMPLES / 'ros1/launch/demo.launch').getroot()
    simulation = (EXAMPLES / 'ros1/sim_node.cpp').read_text(encoding='utf-8')
    arguments = {e.attrib['name']: e.attrib for e in launch.findall('arg')}
    read = re.findall(r'read\("(\w+)"', simulation)
    assert set(read) == {e.attrib['name'] for e in launch.find('node').findall('param')}, read
    assert set(read) <= set(arguments), read
    models = (EXAMPLES / '../include/agrisee/study/noise_model.hpp').read_text(encoding='utf-8')
    known = re.search(r'kNoiseNames =\s*"([^"]*)"', models).group(1)
    words = [set(re.findall(r'[a-z][a-z0-9-]+', re.sub(r'\(.*?\)', '', text))) for text in (known, arguments['noise']['doc'])]
    assert words[0] - {'rough'} <= words[1], words  # which is of the poses, too



for test in (test_launch, test_rviz, test_packages, test_demo):
    test()
    print('ok', test.__name__)
