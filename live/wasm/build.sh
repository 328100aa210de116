#!/bin/sh
# Compiles the engine of `isochor live --export` to WebAssembly, into build-wasm/ or the folder that is given:
#   live/wasm/build.sh [FOLDER] [JOBS]
# Needs Emscripten and what else a build needs without libraries: apt-get install emscripten libeigen3-dev nlohmann-json3-dev.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=${1:-$root/build-wasm}
modules=$(em-config EMSCRIPTEN_ROOT 2>/dev/null) || {
  echo "live/wasm/build.sh: there is no Emscripten; apt-get install emscripten" >&2
  exit 1
}
# The engine as it is, without what has no library here. Clang 14 warns of more than the compiler that the project is built with. Exceptions of WebAssembly cost nothing where none is thrown.
cmake -S "$root" -B "$folder" -G Ninja \
  -DCMAKE_TOOLCHAIN_FILE="$modules/cmake/Modules/Platform/Emscripten.cmake" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS="-fwasm-exceptions -msimd128" -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" \
  -DEigen3_DIR=/usr/share/eigen3/cmake -Dnlohmann_json_DIR=/usr/share/cmake/nlohmann_json \
  -DISOCHOR_LIVE_WASM=ON -DISOCHOR_NATIVE=OFF -DISOCHOR_WERROR=OFF -DISOCHOR_WITH_TBB=OFF -DISOCHOR_WITH_VTU=OFF \
  -DISOCHOR_WITH_MUMPS=OFF -DISOCHOR_WITH_CHOLMOD=OFF -DISOCHOR_WITH_METIS=OFF \
  -DISOCHOR_APPS=OFF -DISOCHOR_TESTS=OFF -DISOCHOR_BENCHMARKS=OFF
# Debian's packages for Node.js are where other builds of it do not look.
export NODE_PATH="${NODE_PATH:-/usr/share/nodejs}"
cmake --build "$folder" -j "${2:-$(nproc)}" --target isochor_live_engine isochor_steps
ls -l "$folder"/isochor_live_engine.js "$folder"/isochor_live_engine.wasm
