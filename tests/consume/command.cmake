# Runs the installed command on an installed pipeline and opens the result with h5py.
file(REMOVE_RECURSE ${output})
execute_process(COMMAND ${prefix}/bin/grainvdb run ${prefix}/share/grainvdb/pipelines/minimal.yaml --output ${output}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${python} ${CMAKE_CURRENT_LIST_DIR}/read_result.py ${output}/fields.hdf COMMAND_ERROR_IS_FATAL ANY)
