# SPDX-License-Identifier: MIT
#
# cmake -DSCENES="a/scene.yaml;b/scene.yaml" -DFILES="b/b/map.png" -DOUT=... -P embed.cmake: a C file with the
# lists of src/app/examples.h. Names are those of the folders, titles those of the scenes; FILES are what scenes name.
set(arrays "")
set(rows "")
set(others "")
set(n 0)

# Bytes, sixteen a line: a string literal may be too long for the language.
function(embed file array)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "((0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,))" "  \\1\n" bytes "${bytes}")
  set(arrays "${arrays}static const unsigned char ${array}[] = {\n${bytes}0};\n\n" PARENT_SCOPE)
endfunction()

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

  embed(${scene} scene_${n})
  string(APPEND rows "  {\"${name}\", \"${title}\", scene_${n}, sizeof scene_${n} - 1},\n")
  math(EXPR n "${n} + 1")
endforeach()

foreach(file IN LISTS FILES)
  get_filename_component(folder ${file} DIRECTORY)
  get_filename_component(example ${folder} DIRECTORY)
  file(RELATIVE_PATH path ${example} ${file})
  get_filename_component(example ${example} NAME)
  embed(${file} file_${n})
  string(APPEND others "  {\"${example}\", \"${path}\", file_${n}, sizeof file_${n} - 1},\n")
  math(EXPR n "${n} + 1")
endforeach()

set(text "/* SPDX-License-Identifier: MIT\n *\n * Made by cmake/embed.cmake of the scenes in examples/.\n */\n")
string(APPEND text "#include \"app/examples.h\"\n\n${arrays}")
string(APPEND text "const cf_example cf_examples[] = {\n${rows}  {0, 0, 0, 0}};\n\n")
string(APPEND text "const cf_example_file cf_example_files[] = {\n${others}  {0, 0, 0, 0}};\n")
file(WRITE ${OUT} "${text}")
