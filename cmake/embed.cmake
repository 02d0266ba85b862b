# SPDX-License-Identifier: MIT
#
# cmake -DSCENES="a/scene.yaml;b/scene.yaml" -DOUT=... -P embed.cmake: a C file with the list of
# src/app/examples.h. Names are those of the folders, titles those of the scenes.
set(arrays "")
set(rows "")
set(n 0)
foreach(scene IN LISTS SCENES)
  get_filename_component(folder ${scene} DIRECTORY)
  get_filename_component(name ${folder} NAME)

  set(title "")
  file(STRINGS ${scene} line REGEX "^title:" LIMIT_COUNT 1)
  if(line)
    string(REGEX REPLACE "^title:[ \t]*" "" title "${line}")
    string(REGEX REPLACE "[ \t]+#.*$" "" title "${title}")
    string(REGEX REPLACE "^\"(.*)\"$" "\\1" title "${title}")
    string(REGEX REPLACE "^'(.*)'$" "\\1" title "${title}")
    string(REPLACE "\\" "\\\\" title "${title}")
    string(REPLACE "\"" "\\\"" title "${title}")
  endif()

  # Bytes, sixteen a line: a string literal may be too long for the language.
  file(READ ${scene} bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "((0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,))" "  \\1\n" bytes "${bytes}")
  string(APPEND arrays "static const unsigned char scene_${n}[] = {\n${bytes}0};\n\n")
  string(APPEND rows "  {\"${name}\", \"${title}\", scene_${n}, sizeof scene_${n} - 1},\n")
  math(EXPR n "${n} + 1")
endforeach()

set(text "/* SPDX-License-Identifier: MIT\n *\n * Made by cmake/embed.cmake of the scenes in examples/.\n */\n")
string(APPEND text "#include \"app/examples.h\"\n\n${arrays}")
string(APPEND text "const cf_example cf_examples[] = {\n${rows}  {0, 0, 0, 0}};\n")
file(WRITE ${OUT} "${text}")
