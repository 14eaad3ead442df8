# SPDX-License-Identifier: BSD-3-Clause
# Writes a text file as a C++ string literal. Run as:
#   cmake -DINPUT=<file> -DOUTPUT=<file.cpp> -DNAME=<variable> -P EmbedText.cmake
# The variable is a std::string_view in agrisee::cli. The literal is raw, so that nothing has to be escaped.
cmake_minimum_required(VERSION 3.16)
file(READ "${INPUT}" text)
get_filename_component(file "${INPUT}" NAME)
file(WRITE "${OUTPUT}" "// Generated from ${file}.\n#include <string_view>\n\nnamespace agrisee::cli {\n\n"
  "extern const std::string_view ${NAME};\nconst std::string_view ${NAME} = R\"agrisee(${text})agrisee\";\n\n"
  "}  // namespace agrisee::cli\n")
