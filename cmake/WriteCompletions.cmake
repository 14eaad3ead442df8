# SPDX-License-Identifier: BSD-3-Clause
# Writes the page for man, and the scripts that complete words in a shell, each under the name that is looked for:
#   cmake -DAGRISEE=<program> -DFOLDER=<folder> -P WriteCompletions.cmake
cmake_minimum_required(VERSION 3.16)
file(MAKE_DIRECTORY "${FOLDER}")
execute_process(COMMAND "${AGRISEE}" manual OUTPUT_FILE "${FOLDER}/agrisee.1" RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${AGRISEE} manual: ${failed}")
endif()
foreach(pair bash=agrisee zsh=_agrisee fish=agrisee.fish)
  string(REPLACE "=" ";" pair ${pair})
  list(GET pair 0 shell)
  list(GET pair 1 name)
  execute_process(COMMAND "${AGRISEE}" completion ${shell} OUTPUT_FILE "${FOLDER}/${name}" RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${AGRISEE} completion ${shell}: ${failed}")
  endif()
endforeach()
