#pragma once

// The OpenGL functions, for .cpp files of gpu/ only: nothing above this folder names GL.
#ifdef __EMSCRIPTEN__
#include <GLES3/gl3.h>
#else
#include <epoxy/gl.h>
#endif
