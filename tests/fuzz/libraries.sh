#!/bin/sh
# HDF5 and libfyaml as the fuzzers find most with: instrumented by clang, static, from the source packages of the distribution
# (Debian, Ubuntu; its list of sources needs `deb-src`, and m4 and dpkg-dev must be there). Ends with what to configure with.
# usage: libraries.sh FOLDER
set -eu
mkdir -p "$1"
folder=$(cd "$1" && pwd)
flags="-O1 -g1 -w -fsanitize=address,fuzzer-no-link"
export ASAN_OPTIONS=detect_leaks=0 # of the programs that the builds run
cd "$folder"
apt-get source hdf5 libfyaml

# HDF5's configuration looks in its build folder for a file that its probe leaves in the working one.
mkdir -p hdf5
(cd hdf5 && cmake -G Ninja -S ../hdf5-*/ -B . -DCMAKE_INSTALL_PREFIX="$folder" -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_C_FLAGS="$flags" -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DHDF5_BUILD_TOOLS=OFF -DHDF5_BUILD_EXAMPLES=OFF \
    -DHDF5_BUILD_HL_LIB=OFF -DHDF5_BUILD_CPP_LIB=OFF -DHDF5_ENABLE_Z_LIB_SUPPORT=ON -DHDF5_ENABLE_SZIP_SUPPORT=OFF)
cmake --build hdf5 --target install

(cd libfyaml-*/ && ./configure CC=clang CFLAGS="$flags" --disable-shared --enable-static --prefix="$folder")
make -C libfyaml-*/src libfyaml.la
mkdir -p lib/pkgconfig include
cp libfyaml-*/src/.libs/libfyaml.a lib
cp libfyaml-*/include/libfyaml.h include
cp libfyaml-*/libfyaml.pc lib/pkgconfig

cat <<END
PKG_CONFIG_PATH=$folder/lib/pkgconfig cmake --preset fuzz -DCMAKE_PREFIX_PATH=$folder -DCMAKE_C_STANDARD_LIBRARIES='-lz -ldl' -DCMAKE_CXX_STANDARD_LIBRARIES='-lz -ldl'
cmake --build --preset fuzz
END
