# What tests of commands share, to be sourced.

failures=0

# expect WHAT STATUS TEXT COMMAND...: the command ends with the status, and prints the text.
expect() {
  local what=$1 status=$2 text=$3 said ended
  shift 3
  said=$("$@" 2>&1)
  ended=$?
  if [ "$ended" = "$status" ] && grep -qF -- "$text" <<< "$said"; then
    echo "ok: $what"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: ended with $ended, not $status with \"$text\": $said"
  fi
}
