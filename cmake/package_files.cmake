# Run by cpack between installing and packing: files that only a Debian package has.
set(tree ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(doc ${tree}/usr/share/doc/fathom)

# CPACK_STRIP_FILES reaches targets alone, and processes are installed under another name.
file(GLOB programs ${tree}/usr/bin/fathom-*)
execute_process(COMMAND ${CPACK_FATHOM_STRIP} --strip-unneeded ${programs} COMMAND_ERROR_IS_FATAL ANY)

file(COPY_FILE ${debian}/copyright ${doc}/copyright)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${doc}/changelog "fathom (${CPACK_PACKAGE_VERSION}) bookworm; urgency=medium

  * Built from its repository; CHANGELOG.md tells what changed.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
execute_process(COMMAND gzip -9nf ${doc}/changelog COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND gzip -9nf ${doc}/CHANGELOG.md COMMAND_ERROR_IS_FATAL ANY)

file(MAKE_DIRECTORY ${tree}/etc/default ${tree}/etc/fathom)
file(COPY_FILE ${debian}/fathom.default ${tree}/etc/default/fathom)
file(COPY_FILE ${CPACK_FATHOM_SOURCE}/procman/tank.cfg ${tree}/etc/fathom/allow.cfg)
file(CHMOD ${tree}/etc/default/fathom ${tree}/etc/fathom/allow.cfg ${doc}/copyright
     PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
