# The command `tagalong` in a box: docker build -t tagalong . ; docker run --rm -v "$PWD/out:/work/out" tagalong demo
FROM python:3.13-slim AS built
WORKDIR /source
COPY . .
RUN python -m venv /opt/tagalong \
    && /opt/tagalong/bin/pip install --no-cache-dir -c constraints.txt ".[viz,ros]"

FROM python:3.13-slim
COPY --from=built /opt/tagalong /opt/tagalong
# kernels are compiled once, into a folder that any user may write to
ENV PATH=/opt/tagalong/bin:$PATH NUMBA_CACHE_DIR=/var/cache/tagalong MPLCONFIGDIR=/var/cache/tagalong
RUN useradd --create-home tagalong && install -d -o tagalong /work /var/cache/tagalong
USER tagalong
WORKDIR /work
# what is used most is compiled in the image, not in its first run; it also proves that the image works
RUN tagalong doctor --no-opengl
ENTRYPOINT ["tagalong"]
CMD ["--help"]
