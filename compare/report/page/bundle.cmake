# Makes BUILD/page.html of page.html, page.css and main.js: cmake -DSOURCE=... -DBUILD=... -DESBUILD=...
# -DFULL=ON|OFF -DHUES=JSON -P bundle.cmake. The content security policy allows this one script, and no request.
set(options --bundle --minify --format=iife --target=es2022 --charset=utf8 --legal-comments=none
  --log-level=warning --define:HUES=${HUES})
if(FULL)
  set(ENV{NODE_PATH} ${BUILD}/node_modules)
  list(APPEND options --define:FULL=true)
else()
  list(APPEND options --define:FULL=false)
  set(ENV{NODE_PATH} ${BUILD}/absent)
  foreach(module three/index.js three/addons/renderers/SVGRenderer.js @observablehq/plot/index.js)
    file(WRITE ${BUILD}/absent/${module} "module.exports = {};\n")
  endforeach()
endif()
if(ESBUILD)
  execute_process(COMMAND ${ESBUILD} ${SOURCE}/main.js ${options} --outfile=${BUILD}/main.js
    COMMAND_ERROR_IS_FATAL ANY)
else()
  file(WRITE ${BUILD}/main.js "document.getElementById('main').textContent = 'This build of plumb has no page: \
read summary.md and results.csv next to this file. Debian package esbuild, or npm, adds the page.';\n")
endif()
file(READ ${BUILD}/main.js script)
file(READ ${SOURCE}/page.html page)
file(READ ${SOURCE}/page.css style)

# The policy names the script by its SHA-256 in base64.
execute_process(COMMAND bash -c "printf \"$(sha256sum '${BUILD}/main.js' | cut -c1-64 | sed 's/../\\\\x&/g')\" | base64 -w0"
  OUTPUT_VARIABLE hash COMMAND_ERROR_IS_FATAL ANY)

# The licence of every package that may be bundled, as a JSON object.
set(licences "{\"\": \"\"")
if(FULL)
  file(GLOB texts ${BUILD}/node_modules/*/LICENSE* ${BUILD}/node_modules/@observablehq/*/LICENSE*)
  foreach(file ${texts})
    get_filename_component(package ${file} DIRECTORY)
    file(RELATIVE_PATH package ${BUILD}/node_modules ${package})
    if(package MATCHES "esbuild")
      continue()
    endif()
    file(READ ${file} text)
    string(REGEX REPLACE "\r" "" text "${text}")
    string(REPLACE "\\" "\\\\" text "${text}")
    string(REPLACE "\"" "\\\"" text "${text}")
    string(REPLACE "\t" " " text "${text}")
    string(REPLACE "\n" "\\n" text "${text}")
    string(REPLACE "<" "\\u003c" text "${text}")
    string(APPEND licences ", \"${package}\": \"${text}\"")
  endforeach()
endif()
string(APPEND licences "}")

# Each piece goes into a place that no other piece contains, the script last.
string(REPLACE "<!--style-->" "${style}" page "${page}")
string(REPLACE "<!--hash-->" "${hash}" page "${page}")
string(REPLACE "<!--licences-->" "${licences}" page "${page}")
string(REPLACE "<!--script-->" "${script}" page "${page}")
file(WRITE ${BUILD}/page.html "${page}")
