# syntax=docker/dockerfile:1
# The service in a container; compose.yaml has it with PostgreSQL and workers of their own. Without access keys it listens on
# loopback only, so one container alone runs on the host's network:
#   docker build -t lineofaction . && docker run --rm --network host -v lineofaction:/data lineofaction
# BASE may name a digest (docs/operations.md); VERSION and REVISION are what the labels say.
ARG BASE=python:3.13-slim-trixie
ARG VERSION=unknown
ARG REVISION=unknown

# ---- build: a virtual environment from the lock file -------------------------------------------------------------
FROM ${BASE} AS build
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1 PYTHONDONTWRITEBYTECODE=1
RUN test "$(uname -m)" = x86_64 || { echo "gmsh and pymetis have no wheels for Linux on $(uname -m): docs/operations.md" >&2; exit 1; }
RUN python -m venv /opt/lineofaction
ENV PATH=/opt/lineofaction/bin:$PATH
WORKDIR /source

# The requirements change seldom: they make a layer of their own.
COPY requirements.lock ./
RUN pip install --no-compile --require-hashes -r requirements.lock

COPY pyproject.toml README.md LICENSE ./
COPY host host
COPY bounds bounds
COPY model_studies model_studies
COPY fe_contact fe_contact
COPY dynamics dynamics
COPY lineofaction lineofaction
COPY service service
RUN pip install --no-compile --no-deps --no-build-isolation . && pip uninstall --yes pip setuptools

# What no run reads: tests and C sources of the libraries, manuals, Python objects for plotly's figures (its JavaScript is what
# we use), fonts for PDF and the codec of AVIF (we write PNG), symbols of the compiler.
RUN apt-get update && apt-get install -y --no-install-recommends binutils
RUN set -eu; packages=$(python -c "import sysconfig; print(sysconfig.get_path('purelib'))"); \
    find "$packages" -type d -name tests -prune -exec rm -rf {} +; \
    find "$packages" -type f -not -path '*/dynamics/*' -regextype egrep -regex '.*\.(pyi|pyx|pxd|c|cpp|h|hpp|a)' -delete; \
    rm -rf "$packages"/plotly/graph_objs "$packages"/plotly/validators "$packages"/plotly/labextension \
        "$packages"/plotly/package_data/widgetbundle.js "$packages"/matplotlib/mpl-data/fonts/pdfcorefonts \
        "$packages"/PIL/_avif*.so "$packages"/pillow.libs/libavif* \
        /opt/lineofaction/lib/gmsh.jl /opt/lineofaction/share /opt/lineofaction/include; \
    strip --strip-unneeded "$packages"/llvmlite/binding/libllvmlite.so

# ---- run: no compiler, no package manager of Python, no root -------------------------------------------------------
# gmsh is linked against OpenGL but draws nothing here: Mesa's drivers (200 MB) go again. NGSolve needs libquadmath.
FROM ${BASE} AS run
ARG VERSION
RUN apt-get update \
    && apt-get install -y --no-install-recommends \
        tini libglu1-mesa libgl1 libxcursor1 libxft2 libxinerama1 libgomp1 libquadmath0 \
    && dpkg --purge --force-depends \
        $(dpkg-query -W -f '${Package}\n' 'libllvm*' 'libz3*' 'mesa-libgallium' 'libgl1-mesa-dri' 2>/dev/null) \
    && apt-get clean && rm -rf /var/lib/apt/lists/* \
    && useradd --system --uid 10001 --no-create-home --shell /usr/sbin/nologin lineofaction \
    && install -d -o lineofaction -g lineofaction /data /data/cache /data/service /data/service/compliance /results
COPY --from=build /opt/lineofaction /opt/lineofaction

# What else is compiled is cached beside the data, so that it survives the container.
ENV PATH=/opt/lineofaction/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    LOA_HOST=127.0.0.1 \
    LOA_PORT=8321 \
    LOA_MANAGEMENT_PORT=8322 \
    LOA_DATA_DIRECTORY=/data/service \
    NUMBA_CACHE_DIR=/data/cache/compiled-${VERSION} \
    XDG_CACHE_HOME=/data/cache \
    MPLCONFIGDIR=/data/cache/matplotlib \
    OMP_NUM_THREADS=1
RUN --mount=type=bind,source=scripts/sbom.py,target=/tmp/sbom.py \
    PYTHONDONTWRITEBYTECODE=1 python /tmp/sbom.py /usr/share/sbom/lineofaction.cdx.json
# Byte code of the modules that the service, its workers and the verbs load, those of Python's own library included: the base
# image has none of these, and the service's user can write none, so each process would compile 300 modules anew.
RUN --mount=type=bind,source=scripts/image_modules.py,target=/tmp/image_modules.py \
    MPLCONFIGDIR=/tmp/matplotlib XDG_CACHE_HOME=/tmp/cache \
    python /tmp/image_modules.py && rm -rf /tmp/matplotlib /tmp/cache
# Loops of first tables and of a run-up, for families of processors; a builder without AVX-512 leaves those of v4 out. Modules
# that only a computation loads get their byte code here.
RUN --mount=type=bind,source=scripts/build_loops.py,target=/tmp/build/scripts/build_loops.py \
    --mount=type=bind,source=examples,target=/tmp/build/examples \
    MPLCONFIGDIR=/tmp/matplotlib XDG_CACHE_HOME=/tmp/cache \
    python /tmp/build/scripts/build_loops.py x86-64-v3 x86-64-v4 && rm -rf /tmp/matplotlib /tmp/cache
USER lineofaction
WORKDIR /data
VOLUME /data
EXPOSE 8321 8322
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=15s --timeout=4s --start-period=30s --retries=3 \
    CMD ["python", "-c", "import os, urllib.request; urllib.request.urlopen(f\"http://127.0.0.1:{os.environ['LOA_MANAGEMENT_PORT']}/health\", timeout=3)"]
ENTRYPOINT ["tini", "--"]
CMD ["loa", "serve"]

# Last: what changes with every build.
ARG BASE
ARG VERSION
ARG REVISION
LABEL org.opencontainers.image.title="lineofaction" \
    org.opencontainers.image.description="Contact analysis for gear noise over HTTP, and its workers" \
    org.opencontainers.image.licenses="GPL-3.0-or-later" \
    org.opencontainers.image.version="${VERSION}" \
    org.opencontainers.image.revision="${REVISION}" \
    org.opencontainers.image.base.name="${BASE}" \
    lineofaction.sbom="/usr/share/sbom/lineofaction.cdx.json"
