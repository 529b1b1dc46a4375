# The program in a container. Build it in a clone:
#   docker build --target cpu -t aligngs .            (podman and buildah take the same)
#   docker build --target cuda -t aligngs:cuda .      for NVIDIA GPUs; run it with --gpus all
# Run it with one volume for everything that is read and written:
#   docker run --rm --read-only --tmpfs /tmp -v "$PWD:/data" --user "$(id -u)" aligngs run photos -o run
# scripts/check_image.sh runs the stages "cpu-files" and "cpu" in a clean Debian without a container engine.

FROM debian:12 AS build
RUN apt-get update -qq && apt-get install -qq -y --no-install-recommends ca-certificates dpkg-dev file
COPY . /src
WORKDIR /src
ARG WITH_CUDA=OFF
RUN scripts/setup.sh
RUN scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON -DALIGNGS_WITH_CUDA=$WITH_CUDA
RUN scripts/package.sh build

FROM debian:12-slim AS cpu-files
COPY --from=build /src/dist /tmp/dist
RUN apt-get update -qq && apt-get install -qq -y --no-install-recommends ca-certificates /tmp/dist/aligngs_*.deb
RUN useradd --uid 1000 --create-home aligngs && mkdir -p /data && chown aligngs /data
COPY scripts/image_files.sh /tmp/image_files.sh
RUN sh /tmp/image_files.sh /image

# The program, its libraries and a shell, without a package manager: two thirds of the size.
FROM scratch AS cpu
COPY --from=cpu-files /image /
ENV ALIGNGS_MODELS=/data/models
WORKDIR /data
USER 1000
ENTRYPOINT ["aligngs"]
CMD ["doctor"]

# The toolkit compiles for the architectures of CUDAARCHS. The program brings the CUDA run-time; the host gives the driver.
FROM nvidia/cuda:12.6.3-devel-ubuntu24.04 AS build-cuda
RUN apt-get update -qq && apt-get install -qq -y --no-install-recommends ca-certificates dpkg-dev file
COPY . /src
WORKDIR /src
ENV CUDAARCHS=80;86;89;90
RUN scripts/setup.sh
RUN scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON -DALIGNGS_WITH_CUDA=ON
RUN scripts/package.sh build

FROM ubuntu:24.04 AS cuda
COPY --from=build-cuda /src/dist /tmp/dist
RUN apt-get update -qq && apt-get install -qq -y --no-install-recommends ca-certificates /tmp/dist/aligngs_*.deb && rm -rf /tmp/dist /var/lib/apt/lists/*
RUN userdel --remove ubuntu; useradd --uid 1000 --create-home aligngs && mkdir -p /data && chown aligngs /data
ENV ALIGNGS_MODELS=/data/models NVIDIA_VISIBLE_DEVICES=all NVIDIA_DRIVER_CAPABILITIES=compute,utility
WORKDIR /data
USER 1000
ENTRYPOINT ["aligngs"]
CMD ["doctor"]
