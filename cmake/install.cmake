# Installation: the library, its header, the program, and what CMake and pkg-config need to find them.
include(CMakePackageConfigHelpers)

install(TARGETS brio EXPORT brioTargets)
install(TARGETS brio-cli)
install(FILES ${CMAKE_SOURCE_DIR}/include/brio/brio.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brio)

# CMake: find_package(brio), then link with brio::brio.
set(BRIO_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/brio)
configure_package_config_file(cmake/brioConfig.cmake.in ${CMAKE_BINARY_DIR}/brioConfig.cmake
                              INSTALL_DESTINATION ${BRIO_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/brioConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT brioTargets NAMESPACE brio:: DESTINATION ${BRIO_CMAKE_DIR})
install(FILES ${CMAKE_BINARY_DIR}/brioConfig.cmake ${CMAKE_BINARY_DIR}/brioConfigVersion.cmake
        DESTINATION ${BRIO_CMAKE_DIR})

# pkg-config: the folders are relative to the file, so that an installed tree can be moved. What a static library needs
# itself its users need too.
file(RELATIVE_PATH BRIO_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" BRIO_PC_PREFIX "${BRIO_PC_PREFIX}")
list(TRANSFORM BRIO_PACKED_LIBRARIES PREPEND " -l" OUTPUT_VARIABLE BRIO_PC_PACKED)
string(JOIN "" BRIO_PC_PACKED ${BRIO_PC_PACKED})
string(STRIP "${CMAKE_THREAD_LIBS_INIT}${BRIO_PC_PACKED} -lm" BRIO_PC_LIBRARIES)
if(BUILD_SHARED_LIBS)
  set(BRIO_PC_STATIC_LIBRARIES "")
else()
  set(BRIO_PC_STATIC_LIBRARIES " ${BRIO_PC_LIBRARIES}")
endif()
configure_file(cmake/brio.pc.in ${CMAKE_BINARY_DIR}/brio.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/brio.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
