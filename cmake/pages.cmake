# Manual pages and completions of shells. A program made of the command line's own tables writes them, so that they say
# what --help says: below pages/ of the build folder, for the installation.
set(BRIO_PAGES ${PROJECT_BINARY_DIR}/pages)
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "No manual pages and completions: the program that writes them cannot run on this machine")
  return()
endif()

file(GLOB BRIO_PAGES_SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cli/pages/*.c)
add_executable(brio-pages ${BRIO_PAGES_SOURCES} $<TARGET_OBJECTS:brio-cli-objects>)
target_include_directories(brio-pages PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(brio-pages PRIVATE brio-laboratory brio-testdata brio m)

string(TIMESTAMP BRIO_PAGES_DATE "%Y-%m-%d" UTC) # that of SOURCE_DATE_EPOCH where it is set
add_custom_command(OUTPUT ${BRIO_PAGES}/written
                   COMMAND ${CMAKE_COMMAND} -E rm -rf ${BRIO_PAGES}
                   COMMAND ${CMAKE_COMMAND} -E make_directory ${BRIO_PAGES}/man1 ${BRIO_PAGES}/bash ${BRIO_PAGES}/zsh
                   COMMAND brio-pages ${BRIO_PAGES} ${BRIO_PAGES_DATE}
                   COMMAND ${CMAKE_COMMAND} -E touch ${BRIO_PAGES}/written
                   DEPENDS brio-pages VERBATIM)
add_custom_target(pages DEPENDS ${BRIO_PAGES}/written)
add_dependencies(brio-cli pages) # what builds the program can be installed

install(DIRECTORY ${BRIO_PAGES}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${BRIO_PAGES}/bash/brio DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${BRIO_PAGES}/zsh/_brio DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
