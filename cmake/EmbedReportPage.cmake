# SPDX-License-Identifier: BSD-3-Clause
# Writes an ASCII file as C++ string literals. Run as: cmake -DINPUT=<file> -DOUTPUT=<file.cpp> -P EmbedReportPage.cmake
# Literals are kept below the 16 KB that every compiler takes; raw ones, so that nothing needs escaping.
cmake_minimum_required(VERSION 3.16)
file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
set(out "// Generated from viewer/report.template.html.\n#include \"report_page.hpp\"\n\nnamespace agrisee::io {\n\n")
string(APPEND out "const std::string_view kReportPage[] = {\n")
set(at 0)
set(pieces 0)
while(at LESS length)
  string(SUBSTRING "${text}" ${at} 15000 piece)
  string(APPEND out "R\"agrisee(${piece})agrisee\",\n")
  math(EXPR at "${at} + 15000")
  math(EXPR pieces "${pieces} + 1")
endwhile()
string(APPEND out "};\nconst std::size_t kReportPagePieces = ${pieces};\n\n}  // namespace agrisee::io\n")
file(WRITE "${OUTPUT}" "${out}")
