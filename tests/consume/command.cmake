# Runs the installed command on an installed pipeline, opens the result with h5py and with the installed Python package, and
# makes its page.
file(REMOVE_RECURSE ${output})
execute_process(COMMAND ${prefix}/bin/grainvdb run ${prefix}/share/grainvdb/pipelines/minimal.yaml --output ${output}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${python} ${CMAKE_CURRENT_LIST_DIR}/read_result.py ${output}/fields.hdf COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${prefix}/share/grainvdb/python
    ${python} ${CMAKE_CURRENT_LIST_DIR}/import_package.py ${prefix} ${output}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=PYTHONPATH GRAINVDB_PYTHON=${python} ${prefix}/bin/grainvdb report ${output}
  COMMAND_ERROR_IS_FATAL ANY)
file(READ ${output}/report/report.html page)
if(NOT page MATCHES "<h2[^>]*>Profiles</h2>")
  message(FATAL_ERROR "${output}/report/report.html has no profiles")
endif()
