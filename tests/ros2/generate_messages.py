# SPDX-License-Identifier: BSD-3-Clause
"""C++ message types of a ROS 2 release, without ROS 2: Debian's rosidl makes them from the release's own definitions, which the npm
package @foxglove/rosmsg-msgs-common holds (folders ros2humble, ros2jazzy).

    generate_messages.py DEFINITIONS OUT TYPE...    # TYPE: sensor_msgs/msg/Image; those it is made of come along

OUT becomes an include folder: <sensor_msgs/msg/image.hpp>. The package holds no services, so the only one needed is stated here.
"""
import contextlib
import io
import json
import os
import pathlib
import re
import sys

from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.parser import parse_message_string
from rosidl_adapter.srv import convert_srv_to_idl
from rosidl_generator_cpp import generate_cpp

TEMPLATES = pathlib.Path('/usr/share/rosidl_generator_cpp/resource')
SERVICES = {'std_srvs/srv/Trigger': '---\nbool success\nstring message\n'}
CONVERT = {'msg': convert_msg_to_idl, 'srv': convert_srv_to_idl}


def definition(definitions, package, kind, name):
    if kind == 'srv':
        return SERVICES[f'{package}/{kind}/{name}']
    text = (definitions / package / kind / f'{name}.msg').read_text(encoding='utf-8')
    return re.split('^={20,}$', text, flags=re.MULTILINE)[0]  # some files go on with the definitions of their parts


def with_parts(definitions, types):
    """The types and all that their fields are made of, with their definitions."""
    todo, found = list(types), {}
    while todo:
        package, kind, name = todo.pop().split('/')
        if (package, kind, name) in found:
            continue
        text = definition(definitions, package, kind, name)
        found[package, kind, name] = text
        if kind == 'msg':
            todo += [f'{field.type.pkg_name}/msg/{field.type.type}' for field in parse_message_string(package, name, text).fields
                     if not field.type.is_primitive_type()]
    return sorted(found.items())


def generate(definitions, out, types):
    idl, by_package = out / 'idl', {}
    for (package, kind, name), text in with_parts(definitions, types):
        source = pathlib.Path(kind, f'{name}.{kind}')
        (idl / package / kind).mkdir(parents=True, exist_ok=True)
        (idl / package / source).write_text(text, encoding='utf-8')
        CONVERT[kind](idl / package, package, source, idl / package / kind)
        by_package.setdefault(package, []).append(f'{idl / package}:{source.with_suffix(".idl")}')
    for package, files in by_package.items():
        arguments = idl / f'{package}.json'
        arguments.write_text(json.dumps({
            'package_name': package, 'output_dir': str(out / package), 'template_dir': str(TEMPLATES), 'idl_tuples': files,
            'ros_interface_dependencies': [], 'target_dependencies': []}), encoding='utf-8')
        generate_cpp(str(arguments))


if __name__ == '__main__':
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    with contextlib.redirect_stdout(io.StringIO()):  # rosidl names every file
        generate(pathlib.Path(sys.argv[1]), pathlib.Path(os.path.abspath(sys.argv[2])), sys.argv[3:])
