"""Writing of results to a REXS document: calculated attributes of stages, bearings and shafts."""
