# To be sourced: how long a long target took when it last ran, kept in the build folder (BUILD, default build).

# last_duration NAME: "it took 312 s the last time", as far as is known.
last_duration() {
  local file=${BUILD:-build}/$1.seconds
  if [ -f "$file" ]; then echo "it took $(cat "$file") s the last time"
  else echo "how long it takes here is not known yet: some minutes"
  fi
}

# keep_duration NAME: that of this shell.
keep_duration() { [ ! -d "${BUILD:-build}" ] || echo "$SECONDS" > "${BUILD:-build}/$1.seconds"; }
