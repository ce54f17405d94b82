# The command in a container:
#   docker build --tag elbowscrew .
#   docker run --rm --volume "$PWD:/data" --user "$(id -u):$(id -g)" elbowscrew analyze trial.csv
FROM python:3.13-slim AS build
WORKDIR /source
COPY . .
RUN pip wheel --no-cache-dir --wheel-dir /wheels ".[c3d,export]"

FROM python:3.13-slim
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir --no-index --find-links /wheels "elbowscrew[c3d,export]"
# Matplotlib keeps a list of fonts; whoever runs the container may have no home.
ENV MPLCONFIGDIR=/tmp/matplotlib
RUN useradd --create-home elbow
USER elbow
WORKDIR /data
ENTRYPOINT ["elbowscrew"]
CMD ["--help"]
