# The command in a container:
#   docker build --tag elbowscrew .
#   docker run --rm --volume "$PWD:/data" --user "$(id -u):$(id -g)" elbowscrew analyze trial.csv
FROM python:3.13-slim AS build
WORKDIR /source
COPY . .
RUN pip wheel --no-cache-dir --wheel-dir /wheels ".[c3d,export]"

FROM python:3.13-slim
# The wheels beside it are the only ones there are.
# hadolint ignore=DL3013
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir --no-index --find-links /wheels "elbowscrew[c3d,export]"
# Matplotlib keeps a list of fonts; whoever runs the container may have no home.
ENV MPLCONFIGDIR=/tmp/matplotlib
RUN useradd --create-home --uid 1000 elbow
USER 1000
WORKDIR /data
ENTRYPOINT ["elbowscrew"]
CMD ["--help"]
