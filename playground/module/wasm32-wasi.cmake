# Toolchain file: Debian's Clang 19 for WebAssembly, see [playground] of .ci/packages.txt. Exceptions do not exist there: what
# is thrown ends the call, see runtime.cpp.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_FLAGS_INIT "-fignore-exceptions -msimd128")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG" CACHE STRING "") # at -O3 the module is larger, and no faster
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
