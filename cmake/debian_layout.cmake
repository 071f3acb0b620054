# Where Debian wants files that others want elsewhere: a compressed man page, zsh's completion beside those of packages.
set(share ${CPACK_TEMPORARY_DIRECTORY}/command/usr/share)
execute_process(COMMAND gzip -9n ${share}/man/man1/rosin.1 COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${share}/zsh/site-functions ${share}/zsh/vendor-completions)
file(RENAME ${share}/doc/rosin/LICENSE ${share}/doc/rosin/copyright)
file(COPY ${share}/doc/rosin/copyright DESTINATION ${CPACK_TEMPORARY_DIRECTORY}/development/usr/share/doc/librosin-dev)
