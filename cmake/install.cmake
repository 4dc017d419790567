# Installation: the library, its headers, the program, and what CMake and pkg-config need to find them.
include(CMakePackageConfigHelpers)

install(TARGETS brio EXPORT brioTargets)
install(TARGETS brio-cli)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/brio DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h"
        PATTERN testdata.h EXCLUDE PATTERN laboratory.h EXCLUDE) # of libraries that are not installed
install(FILES docs/which-method.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}) # errors refer to the first by name

# CMake: find_package(brio), then link with brio::brio.
set(BRIO_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/brio)
configure_package_config_file(cmake/brioConfig.cmake.in ${PROJECT_BINARY_DIR}/brioConfig.cmake
                              INSTALL_DESTINATION ${BRIO_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/brioConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT brioTargets NAMESPACE brio:: DESTINATION ${BRIO_CMAKE_DIR})
install(FILES ${PROJECT_BINARY_DIR}/brioConfig.cmake ${PROJECT_BINARY_DIR}/brioConfigVersion.cmake
        DESTINATION ${BRIO_CMAKE_DIR})

# pkg-config: the folders are relative to the file, so that an installed tree can be moved. What a static library needs
# itself its users need too.
file(RELATIVE_PATH BRIO_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" BRIO_PC_PREFIX "${BRIO_PC_PREFIX}")
string(STRIP "${CMAKE_THREAD_LIBS_INIT} -lm" BRIO_PC_LIBRARIES)
foreach(library ${BRIO_PACKAGED})
  string(APPEND BRIO_PC_LIBRARIES " -l${library}")
endforeach()
if(BUILD_SHARED_LIBS)
  set(BRIO_PC_STATIC_LIBRARIES "")
else()
  set(BRIO_PC_STATIC_LIBRARIES " ${BRIO_PC_LIBRARIES}")
endif()
foreach(folder LIBDIR INCLUDEDIR) # packagers may give folders outside the prefix
  set(BRIO_PC_${folder} "\${prefix}/${CMAKE_INSTALL_${folder}}")
  if(IS_ABSOLUTE "${CMAKE_INSTALL_${folder}}")
    set(BRIO_PC_${folder} "${CMAKE_INSTALL_${folder}}")
  endif()
endforeach()
configure_file(cmake/brio.pc.in ${PROJECT_BINARY_DIR}/brio.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/brio.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
