# `cmake --install` and the Debian package: the program, its manual pages and the completions of three shells. Both
# are made by the program that was just built, so that they cannot fall behind it.
include(GNUInstallDirs)

install(TARGETS aligngs RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(CODE "
  set(program \"$<TARGET_FILE:aligngs>\")
  set(folder \"${CMAKE_BINARY_DIR}/installed_texts\")
  file(REMOVE_RECURSE \"\${folder}\")
  file(MAKE_DIRECTORY \"\${folder}\")
  execute_process(COMMAND \"\${program}\" manual \"\${folder}/man1\" OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB pages \"\${folder}/man1/*.1\")
  execute_process(COMMAND gzip -9n \${pages} COMMAND_ERROR_IS_FATAL ANY)  # as Debian wants them
  foreach(shell bash zsh fish)
    execute_process(COMMAND \"\${program}\" completion \${shell} OUTPUT_FILE \"\${folder}/\${shell}\" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  set(share \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  file(GLOB pages \"\${folder}/man1/*.gz\")
  file(INSTALL \${pages} DESTINATION \"\${share}/man/man1\")
  file(INSTALL \"\${folder}/bash\" DESTINATION \"\${share}/bash-completion/completions\" RENAME aligngs)
  file(INSTALL \"\${folder}/zsh\" DESTINATION \"\${share}/zsh/vendor-completions\" RENAME _aligngs)
  file(INSTALL \"\${folder}/fish\" DESTINATION \"\${share}/fish/vendor_completions.d\" RENAME aligngs.fish)
")

# `cpack -G DEB` in the build folder; scripts/package.sh builds and calls it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME aligngs)
set(CPACK_PACKAGE_CONTACT "The aligngs maintainers <maintainers@aligngs.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "colmap, ffmpeg")
include(CPack)
