# Writes page_text.c: web/page.html, which `npm run build` in web/ bundles from its sources, as arrays of C. Called as a
# script: cmake -DPAGE=web/page.html -DOUT=page_text.c -P page.cmake
file(READ ${PAGE} page HEX)
string(HEX "<!--DATA-->" mark)
string(FIND "${page}" "${mark}" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${PAGE}: has no mark <!--DATA--> for the data")
endif()
string(LENGTH "${mark}" mark_length)
math(EXPR behind "${at} + ${mark_length}")
string(SUBSTRING "${page}" 0 ${at} head)
string(SUBSTRING "${page}" ${behind} -1 tail)
set(text "#include \"page/page.h\"\n")
foreach(part head tail)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${${part}}")
  string(APPEND text "const unsigned char brio_page_${part}[] = {${bytes}};\n"
                     "const size_t brio_page_${part}_size = sizeof brio_page_${part};\n")
endforeach()
file(WRITE ${OUT} "${text}")
