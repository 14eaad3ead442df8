# SPDX-License-Identifier: BSD-3-Clause
# Writes an ASCII file as C++ string literals. Run as: cmake -DINPUT=<file> -DOUTPUT=<file.cpp> -P EmbedReportPage.cmake
# The literals are shorter than 16 KB, which every compiler accepts, and raw, so that nothing has to be escaped.
cmake_minimum_required(VERSION 3.16)
file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
set(out "// Generated from src/io/page/viewer/report.template.html.\n#include \"io/page/page_template.hpp\"\n\nnamespace agrisee::io {\n\n")
string(APPEND out "const std::string_view kPageTemplate[] = {\n")
set(at 0)
set(pieces 0)
while(at LESS length)
  string(SUBSTRING "${text}" ${at} 15000 piece)
  string(APPEND out "R\"agrisee(${piece})agrisee\",\n")
  math(EXPR at "${at} + 15000")
  math(EXPR pieces "${pieces} + 1")
endwhile()
string(APPEND out "};\nconst std::size_t kPageTemplatePieces = ${pieces};\n\n}  // namespace agrisee::io\n")
file(WRITE "${OUTPUT}" "${out}")
