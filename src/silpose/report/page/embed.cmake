# cmake -DFOLDER=... -DOUT=... "-DSCRIPTS=a.js b.js" -P embed.cmake: writes C++ that holds page.html with page.css and
# the scripts, in their order, inside.
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/page.css style)
set(script "")
separate_arguments(SCRIPTS)
foreach(name IN LISTS SCRIPTS)
  file(READ ${FOLDER}/${name} text)
  string(APPEND script "${text}")
endforeach()
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
file(WRITE ${OUT} "#include \"silpose/report/page_template.h\"

namespace silpose {

const std::string_view kPageTemplate = R\"PAGE(${page})PAGE\";

}  // namespace silpose
")
