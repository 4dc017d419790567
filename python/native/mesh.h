/* Calls that make a mesh. */
#ifndef BRIO_PYTHON_MESH_H
#define BRIO_PYTHON_MESH_H

#include "native.h"
#include <stdint.h>

/** Ends a call and makes a handle of the mesh that it made. */
PyObject *call_end_with_mesh(call *c, brio_status status, brio_mesh *mesh);

#endif
