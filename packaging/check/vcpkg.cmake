# Stands for vcpkg: cmake -DPORT=FOLDER -DCURRENT_PACKAGES_DIR=FOLDER -DCURRENT_BUILDTREES_DIR=FOLDER -P vcpkg.cmake. The functions that the port
# calls do what vcpkg's do, for one configuration.
cmake_minimum_required(VERSION 3.20)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
endfunction()

function(expect file)
  if(NOT EXISTS "${CURRENT_PACKAGES_DIR}/${file}")
    message(FATAL_ERROR "the port did not install ${file}")
  endif()
endfunction()

function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
  run(${CMAKE_COMMAND} -S "${arg_SOURCE_PATH}" -B "${CURRENT_BUILDTREES_DIR}" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF
      "-DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR}" -DCMAKE_INSTALL_LIBDIR=lib ${arg_OPTIONS})
endfunction()

function(vcpkg_cmake_install)
  run(${CMAKE_COMMAND} --build "${CURRENT_BUILDTREES_DIR}" --parallel --target install)
endfunction()

function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "CONFIG_PATH" "")
  expect("${arg_CONFIG_PATH}")
  file(MAKE_DIRECTORY "${CURRENT_PACKAGES_DIR}/share")
  file(RENAME "${CURRENT_PACKAGES_DIR}/${arg_CONFIG_PATH}" "${CURRENT_PACKAGES_DIR}/share/brio")
endfunction()

function(vcpkg_fixup_pkgconfig)
  expect(lib/pkgconfig)
  file(GLOB modules "${CURRENT_PACKAGES_DIR}/lib/pkgconfig/*.pc")
  foreach(module ${modules})
    file(STRINGS "${module}" absolute REGEX "^[^#]*${CURRENT_BUILDTREES_DIR}")
    if(absolute)
      message(FATAL_ERROR "${module} names the folder of the build: ${absolute}")
    endif()
  endforeach()
endfunction()

function(vcpkg_copy_tools)
  cmake_parse_arguments(PARSE_ARGV 0 arg "AUTO_CLEAN" "" "TOOL_NAMES")
  foreach(tool ${arg_TOOL_NAMES})
    expect("bin/${tool}")
    file(COPY "${CURRENT_PACKAGES_DIR}/bin/${tool}" DESTINATION "${CURRENT_PACKAGES_DIR}/tools/brio")
    file(REMOVE "${CURRENT_PACKAGES_DIR}/bin/${tool}")
  endforeach()
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
  configure_file("${arg_FILE_LIST}" "${CURRENT_PACKAGES_DIR}/share/brio/copyright" COPYONLY)
endfunction()

set(CMAKE_CURRENT_LIST_DIR "${PORT}") # as in the port's folder
file(READ "${PORT}/portfile.cmake" port)
cmake_language(EVAL CODE "${port}")
