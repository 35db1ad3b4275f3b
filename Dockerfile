# Debian 12 with every package that the targets of make install, for computers without Debian or without root.
# Nothing of the project is inside: mount your checkout.
#   docker build --build-arg uid="$(id -u)" -t raypool .
#   docker run --rm -it -v "$PWD:/raypool" raypool make sim
FROM debian:12
# Groups of scripts/packages.txt.
ARG groups="sim test synth lint sweep report numerics fidelity follow package coverage docs"
COPY scripts/packages.txt scripts/setup.sh /usr/local/share/raypool/scripts/
RUN /usr/local/share/raypool/scripts/setup.sh $groups && rm -rf /var/lib/apt/lists/*
# What is made in the checkout belongs to you.
ARG uid=1000
RUN useradd --create-home --non-unique --uid "$uid" raypool
USER raypool
ENV LANG=C.UTF-8
WORKDIR /raypool
CMD ["bash"]
