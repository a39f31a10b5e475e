#pragma once

// The OpenGL functions, for .cpp files of gpu/ only: nothing above this folder names GL.
#ifdef __EMSCRIPTEN__
#include <GLES3/gl31.h> // 3.1 for the names in code that WebGL never runs
#else
#include <epoxy/gl.h>
#endif
