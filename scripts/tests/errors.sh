#!/bin/bash
# Input that cannot be used gives one clear sentence and a non-zero exit, and spoils no earlier result:
# scripts/tests/errors.sh RAYPOOL
# Needs the Verilated unit of 4w4c beside RAYPOOL.
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

# refuses WHAT PATTERN COMMAND...: exit code 1, nothing but one line on standard error, which matches PATTERN.
refuses() {
  local what=$1 pattern=$2 code=0; shift 2
  timeout 120 "$@" > "$folder/stdout" 2> "$folder/stderr" || code=$?
  if [ "$code" = 1 ] && [ "$(wc -l < "$folder/stderr")" = 1 ] && grep -qE -e "$pattern" "$folder/stderr"; then
    echo "ok: $what: $(cat "$folder/stderr")"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: exit $code, wanted 1 and one line that matches '$pattern', got:"
    cat "$folder/stdout" "$folder/stderr"
    printf 'again:'; printf ' %q' "$@"; echo
  fi
}

triangle='v 0 0 0
v 1 0 0
v 0 1 0'
printf '%s\nf 1 2 9\n' "$triangle" > "$folder/index.obj"
printf '%s\nf 1 2 -9\n' "$triangle" > "$folder/negative.obj"
printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' > "$folder/nan.obj"
printf '%s\nf 1 2 3\n' "$triangle" > "$folder/good.obj"
: > "$folder/empty.ply"
printf 'glTF\x02\0\0\0' > "$folder/cut.glb"
echo '{"warps": 3}' > "$folder/warps.json"
echo '{"warps": ' > "$folder/broken.json"
echo '{"wraps": 8}' > "$folder/unknown.json"
printf 'iadd r1, r1, 1\njany 5000\nexit\n' > "$folder/far.asm"
printf 'iadd r1, r1, 1\n' > "$folder/end.asm"
printf 'mov r1, 0x7ffffff0\nld r2, [r1+0]\nexit\n' > "$folder/load.asm"
printf 'mov r1, 0\nnonsense r1\nexit\n' > "$folder/word.asm"
printf 'mvo r1, 0\nexit\n' > "$folder/mistyped.asm"
printf 'again:\njany agian\nexit\n' > "$folder/label.asm"
printf 'again:\njany again\nexit\n' > "$folder/forever.asm"
printf 'again: tid r1\njany again\nexit\n' > "$folder/spin.asm"
printf '%s\n' 'mov r1, 600000' 'ine p1, r1, 0' '@p1 loop e' '@p1 isub r1, r1, 1' '@p1 ine p1, r1, 0' 'e: exit' \
  > "$folder/count.asm"
printf 'mov r1, 0x402\nld r2, [r1+0]\nexit\n' > "$folder/odd.asm"
printf 'mov r1, 0\nrin\nexit\n' > "$folder/rin.asm"
printf 'exit\n' > "$folder/exit.asm"

# refuses_sim WHAT PATTERN OPTION...: of raypool sim; what the options leave open is chosen here.
refuses_sim() {
  local what=$1 pattern=$2 defaults=(--quiet); shift 2
  [[ " $* " == *" --engine "* ]] || defaults+=(--engine functional)
  [[ " $* " == *" --size "* ]] || defaults+=(--size 8x8)
  [[ " $* " == *" --out "* ]] || defaults+=(--out "$folder/out")
  refuses "$what" "$pattern" "$raypool" sim "${defaults[@]}" "$@"
}
refuses_sim "missing OBJ" "$folder/none.obj" --scene "$folder/none.obj"
refuses_sim "OBJ index out of range" "index.obj" --scene "$folder/index.obj"
refuses_sim "OBJ negative index out of range" "negative.obj" --scene "$folder/negative.obj"
refuses_sim "OBJ with a NaN" "nan.obj" --scene "$folder/nan.obj"
refuses_sim "an error for an engine without a sample" "functional draws no sample: use sampled" --error 2%
refuses_sim "an error that is no share" "--error is '2 percent': it must be a number above 0, at most 50, and %" \
  --engine sampled --error "2 percent"
refuses_sim "an error of nothing" "--error is '0%'" --engine sampled --error 0%
refuses_sim "no time" "--within is '-1s': it must be a number above 0" --engine sampled --within=-1s
refuses_sim "error and time" "give one of them" --engine sampled --error 2% --within 3s
refuses_sim "a sample's trace" "engine sampled leaves no trace" --engine sampled --trace :
refuses_sim "no such scene" "nosuchscene" --scene nosuchscene
refuses_sim "scene of an unknown format" "warps.json: .* \.obj, \.gltf, \.glb or \.ply" --scene "$folder/warps.json"
refuses_sim "empty PLY" "empty.ply: the file is empty" --scene "$folder/empty.ply"
refuses_sim "cut-off glTF" "cut.glb: the file is cut off" --scene "$folder/cut.glb"
refuses_sim "named camera of a scene without" "--camera is for glTF" --scene "$folder/good.obj" --camera Front
refuses_sim "eye of two numbers" "--eye is '1,2'.*three numbers" --eye 1,2
refuses_sim "eye that is not a number" "--eye is '1,nan,3'.*-1e" --eye 1,nan,3
refuses_sim "light too far away" "--light is '0,2e9,0'.*1e" --light 0,2e9,0
refuses_sim "looking at the eye" "look at .1, 2, 3., where its eye is" --eye 1,2,3 --look-at 1,2,3
refuses_sim "looking along up" "up is parallel" --eye 1,2,3 --look-at 1,5,3
refuses_sim "looking along up at an OBJ" "good.obj: .*up is parallel" --scene "$folder/good.obj" --eye 1,2,3 \
  --look-at 1,5,3
refuses_sim "up without a direction" "up is zero" --up 0,0,0
refuses_sim "field of view of a half-circle" "--fov is '180'.*1 to 170" --fov 180
refuses_sim "field of view that is not a number" "--fov is 'wide'" --fov wide
refuses_sim "missing view" "none.json" --view "$folder/none.json"
refuses_sim "3 warps in a file" "warps.* 3.*power of two from 1 to 32" --config "$folder/warps.json"
refuses_sim "3 warps by name" "3.*power of two from 1 to 32" --config 3w8c
refuses_sim "configuration that is not JSON" "broken.json" --config "$folder/broken.json"
refuses_sim "configuration with an unknown key" "wraps" --config "$folder/unknown.json"
refuses_sim "size 0x0" "0x0.*1 to 16384" --size 0x0
refuses_sim "size without x" "1 to 16384" --size 64
refuses_sim "depth 0" "depth.*1" --depth 0
refuses_sim "3 compute units" "3" --units 3
refuses_sim "unknown engine" "native, estimate, functional, sampled, model, rtl or lockstep" --engine spice
refuses_sim "unknown boundary" "no boundary 'board'; use unit or chip" --engine rtl --boundary board
refuses_sim "a boundary without Verilog" "engine model has no Verilog, and so no boundary" --engine model \
  --boundary chip
refuses_sim "unknown hits" "--hits is 'mine'; use own or embree" --engine native --hits mine
refuses_sim "unknown precision" "--precision is 'half'; use single or double" --engine native --precision half
refuses_sim "a machine in double precision" "engine model draws with the arithmetic of its machine" \
  --engine model --precision double
refuses_sim "unstable pixels of a machine" "engine model draws with the arithmetic of its machine" \
  --engine model --unstable 3
refuses_sim "unstable pixels in double precision" "--unstable moves last bits of single precision" --engine native \
  --precision double --unstable 3
refuses_sim "unstable pixels of Embree's hits" "--unstable moves last bits of single precision" --engine native \
  --hits embree --unstable 3
refuses_sim "double precision of 16 bits" "--precision double has neither the arithmetic nor the hits of a machine" \
  --engine native --precision double --set arithmetic.significand=16
refuses_sim "hits of a chip from Embree" "engine model has the hits of its traverser" --engine model --hits embree
refuses_sim "hits of a traverser from Embree" "takes no hits of the machine's traverser" --engine native --hits embree \
  --traverser hardware
refuses_sim "a cache that no hardware has" "node_cache_ways is 1; it must be a power of two from 2 to 16" \
  --engine model --set chip.hardware_traverser.node_cache_ways=1
refuses_sim "more triangle pipes than lanes" "triangle_pipes is 3; it must be at most 2, which is lanes" \
  --engine model --set "chip.hardware_traverser.lanes=2 chip.hardware_traverser.triangle_pipes=3"
refuses_sim "a memory that is faster than the memory port" "chip.memory.latency is 8; .* takes 9 at least" \
  --engine model --set chip.memory.latency=8
refuses_sim "a chip that is not built" "make unit CONFIG=4w4c SET=\"chip.ray_pool.size=77\" BOUNDARY=chip" \
  --engine rtl --boundary chip --config 4w4c --set chip.ray_pool.size=77
refuses_sim "a waveform of the model" "engine model has no waveform" --engine model --waves
refuses_sim "modules of the engine that has no chip" "engine native has no chip" --engine native --modules
refuses_sim "threads of an engine that has one" "engine model runs on one thread" --engine model --threads 2
refuses_sim "more threads than there may be" "Value 257 not in range 1 to 256" --engine native --threads 257
refuses_sim "unknown traverser" "chip.traverser must be one of static, hardware" --traverser quick
refuses_sim "unknown policy" "chip.policy must be one of thesis" --set chip.policy=magic
refuses_sim "unknown field" "no field 'flt.count': did you mean alus.flt.count\?" --set flt.count=2
refuses_sim "value of another type" "warps must be a power of two" --set warps=eight
refuses_sim "set value out of range" "8w8c.json with --set warps=3: warps is 3" --set warps=3
refuses_sim "field without a value" "write FIELD=VALUE" --set warps
refuses_sim "impossible chip" "chip.held_limit is 513" --set chip.held_limit=513
refuses_sim "--set for a unit that is not built" "make unit CONFIG=4w4c SET=\"stack_depth=5\"" --engine rtl \
  --config 4w4c --set stack_depth=5
refuses "compare without a report" "none.json" "$raypool" compare "$folder"/{none,none}.json
refuses "compare with broken JSON" "broken.json: not valid JSON" "$raypool" compare "$folder"/{broken,broken}.json
refuses "compare with foreign JSON" "warps.json: not a report" "$raypool" compare "$folder"/{warps,warps}.json
refuses_sim "engine without a built unit" "make unit" --engine rtl --unit-library "$folder/none.so"
refuses_sim "results folder that is a file" "good.obj" --out "$folder/good.obj"
cosim=("$raypool" cosim --programs 2 --save "$folder/saved" --quiet)
refuses "random programs without a built unit" "none.so.*make" "${cosim[@]}" --config 4w4c \
  --unit-library "$folder/none.so"
refuses "random programs, a unit that is no library" "good.obj.*cannot be loaded" "${cosim[@]}" --config 4w4c \
  --unit-library "$folder/good.obj"
another=$("$raypool" config 4w4c --unit-library)
refuses "random programs on another configuration's unit" "build it for this configuration" \
  "${cosim[@]}" --config 2w2c --unit-library "$another"
refuses "random programs, 3 warps" "3.*power of two from 1 to 32" "${cosim[@]}" --config "$folder/warps.json"
refuses "parameters of a chip that are not asked for" "requires --verilog-parameters" "$raypool" config 4w4c --chip
refuses "program that was not saved" "none.json" "${cosim[@]}" --replay "$folder/none.json"
if [ -e "$folder/saved" ]; then
  failures=$((failures + 1))
  echo "FAILED: what is wrong around the programs was saved as a program that fails: $(ls "$folder/saved")"
fi
refuses_sim "a folder as view" "view file cannot be read \(Is a directory\)" --view "$folder"
refuses_sim "a folder as scene" "a scene cannot be read from this; give cornell, room" --scene "$folder"
refuses_sim "a folder as configuration" "no configuration '$folder'" --config "$folder"
refuses "a folder as saved program" "Is a directory" "$raypool" cosim --replay "$folder"
refuses "a folder as program" "Is a directory" "$raypool" run "$folder"
refuses "a tree into a folder that is not there" "cannot write '.*none/a.bvh' \(No such file" "$raypool" scene cornell \
  --write-bvh "$folder/none/a.bvh"
refuses "a tree in the place of the OBJ" "name the same file" "$raypool" scene cornell --write-obj "$folder/both" \
  --write-bvh "$folder/both"
refuses "a folder as tree" "Is a directory" "$raypool" scene cornell --write-bvh "$folder"
refuses "a folder to assemble" "Is a directory" "$raypool" asm "$folder"
refuses "a folder to write to" "Is a directory" "$raypool" asm "$folder/forever.asm" -o "$folder"
refuses_sim "an option given twice" "--size is given 2 times \(8x8, 9x9\)" --size 8x8 --size 9x9
refuses_sim "a scene by place and by option" "--scene is given 2 times \(cornell, room\)" cornell --scene room
echo '{"warps": 2, "warps": 4}' > "$folder/twice.json"
refuses_sim "a key twice in a configuration" "twice.json: the key \"warps\" stands twice" --config "$folder/twice.json"
echo '{"eye": [0, 0, 1], "eye": [0, 0, 2]}' > "$folder/twice.json"
refuses_sim "a key twice in a view" "twice.json: the key \"eye\" stands twice" --view "$folder/twice.json"
sed '0,/"seed"/ s//"seed": 1, "seed"/' tb/icarus/undefined_register.json > "$folder/twice.json"
refuses "a key twice in a saved program" "twice.json: the key \"seed\" stands twice" "$raypool" cosim \
  --replay "$folder/twice.json"
echo '{"name": "8w8c", "warps": 2}' > "$folder/posing.json"
refuses_sim "other hardware under a built-in name" "'8w8c' stands for other hardware" --config "$folder/posing.json"
refuses_sim "waveform of an engine without one" "waveform" --waves
refuses_sim "trace of an engine without one" "leaves no trace" --trace :
refuses_sim "window of a trace that is none" "FROM:CYCLES" --engine model --trace 5:0
refuses_sim "trace around a pixel outside" "numbered from 0" --engine model --trace pixel:4000,0
refuses_sim "unknown option" "sim has no option --colour; raypool sim --help lists all" --colour
refuses "unknown kernel" "saxpy" "$raypool" run linpack
refuses "no command" "^raypool: give a command, such as sim; raypool --help lists all$" "$raypool"

# What is mistyped: the nearest right word.
means() {
  local meant=$1; shift
  refuses "mistyped: $*" "did you mean $meant\?( \(|$)" "$raypool" "$@"
}
means sim smi
means --scene sim --scen room
means --quiet sim room --queit
means room sim rom
means model sim --engine modle
means chip sim --engine rtl --boundary chp
means embree sim --engine native --hits embre
means double sim --engine native --precision duble
means hardware sim --traverser hardwre
means 'chip.ray_pool.size, .* or .*' sim --set chip.ray_pol=9
means fill sim --set chip.policy=fil
means tiny sim --config tniy
means warps sim --config "$folder/unknown.json"
means saxpy run sexpy
means mov asm "$folder/mistyped.asm"
means again asm "$folder/label.asm"
means cast_eye kernels cast_eey
means operands cosim --config 4w4c --engine model --mix operand
means zsh completion zhs
means show scene --cache shw
means flush-newton1 numerics --mode flush-newtn1
refuses "saxpy of nothing" "--n is 0: saxpy takes a size from 1 to" "$raypool" run saxpy --n 0
refuses "no cycles" "--cycles" "$raypool" run saxpy --cycles 0
# Some 11 million cycles in which nothing is transferred: a limit that was given is the limit.
counts=("$raypool" run "$folder/count.asm" --config 4w4c --threads 4 --quiet)
refuses "silent program without a limit" "for 10000000 cycles .* set a limit with --cycles; .*unit 0: running" \
  "${counts[@]}"
refuses "silent program with a limit" "the limit of 2000000 cycles has passed; " "${counts[@]}" --cycles 2000000
if "${counts[@]}" --cycles 20000000 > "$folder/stdout" 2>&1 && grep -q ' cycles$' "$folder/stdout"; then
  echo "ok: a silent program ends within the limit that was given"
else
  failures=$((failures + 1))
  echo "FAILED: a silent program within its limit:"; cat "$folder/stdout"
fi
# Fields that another field makes meaningless.
refuses_sim "field of another traverser" \
  "rays and chip.hardware_traverser.lanes are not looked at: chip.traverser is static, .*leave them out" \
  --engine model --traverser static --set "chip.hardware_traverser.rays=8 chip.hardware_traverser.lanes=2"
refuses_sim "field of the static traverser" "stall_cycles is not looked at: chip.traverser is not static; choose" \
  --engine model --set chip.static_traverser.stall_cycles=50
refuses_sim "rows of a memory without" "banks is not looked at: chip.memory.row_miss is 0" --engine model \
  --set chip.memory.banks=4
refuses_sim "field of another policy" "chip.thresholds.rays is not looked at: chip.policy is fill" \
  --engine model --set "chip.policy=fill chip.thresholds.rays=9"
refuses_sim "wide memory of narrow units" "wide_ray_memory is not looked at: .* at most four lanes" \
  --engine model --config 4w4c --set wide_ray_memory=true
refuses "chip around a compute program" "chip.ray_pool.size is not looked at: a compute program" \
  "$raypool" run saxpy --set chip.ray_pool.size=9
refuses "fit by a field of another traverser" "not looked at: chip.traverser is static" \
  "$raypool" fit cornell --set "chip.traverser=static chip.hardware_traverser.rays=8"
echo '{"chip": {"traverser": "static", "hardware_traverser": {"rays": 8, "lanes": 2, "stack_entries": 9}}}' \
  > "$folder/lanes.json"
"$raypool" sim cornell --config "$folder/lanes.json" --engine model --size 4x4 --quiet --out "$folder/told" \
  2> "$folder/stderr"
if [ "$(wc -l < "$folder/stderr")" = 1 ] && grep -qE -e \
  "warning: configuration lanes: chip.hardware_traverser.rays and 2 more are not looked at" "$folder/stderr"; then
  echo "ok: fields of a file that are not looked at: $(cat "$folder/stderr")"
else
  failures=$((failures + 1))
  echo "FAILED: fields of a file that are not looked at:"; cat "$folder/stderr"
fi
refuses_sim "frame within no cycles" "the limit of 300 cycles has passed, .* ray pool " --engine model --cycles 300
refuses_sim "limit of what has no cycles" "native .* leave --cycles out" --engine native --cycles 300
for range in 60000:2 252:2 0:4294967295 4294967292:2; do
  refuses "words beyond the memory, $range" "$range goes beyond the memory of 256 bytes" "$raypool" run \
    "$folder/exit.asm" --memory 256 --print "$range"
done
refuses "no words" "at least one" "$raypool" run "$folder/exit.asm" --print 0:0
refuses "an address with a point" "address '1.5'" "$raypool" run "$folder/exit.asm" --print 1.5:1
refuses "assembly error names line and column" "word.asm:2:" "$raypool" run "$folder/word.asm"

for engine in functional rtl lockstep; do
  limit=100000 unit=cycles
  [ "$engine" != functional ] || unit=instructions
  run=("$raypool" run --config 4w4c --engine "$engine" --cycles "$limit" --quiet)
  refuses "$engine: jump out of the program" "outside the program" "${run[@]}" "$folder/far.asm"
  refuses "$engine: program without an end" "outside the program" "${run[@]}" "$folder/end.asm"
  refuses "$engine: load out of memory" "outside the memory" "${run[@]}" "$folder/load.asm"
  refuses "$engine: endless program" "limit of $limit $unit" "${run[@]}" "$folder/forever.asm"
  refuses "$engine: endless program that computes" "limit of $limit $unit" "${run[@]}" "$folder/spin.asm"
  refuses "$engine: misaligned load names its address" "multiple of 4.*thread 0 of block 0 goes to address 0x402$" \
    "${run[@]}" "$folder/odd.asm"
  refuses "$engine: rin in a compute program" "PC 1: rin waits for a ray" "${run[@]}" "$folder/rin.asm"
done

# What an earlier run has left survives a failed one, and nothing else is left.
"$raypool" sim --engine functional --size 8x8 --out "$folder/out" --scene "$folder/good.obj" --quiet \
  > "$folder/stdout" 2>&1 ||
  { failures=$((failures + 1)); echo "FAILED: a good OBJ:"; cat "$folder/stdout"; }
before=$(cd "$folder/out" && ls -A && cksum ./*)
refuses_sim "failed run over an earlier one" "nan.obj" --scene "$folder/nan.obj"
if [ "$before" != "$(cd "$folder/out" && ls -A && cksum ./*)" ]; then
  failures=$((failures + 1))
  echo "FAILED: a failed run changed the results of the earlier one: $(ls -lA "$folder/out")"
fi

sim=("$raypool" sim --engine functional --size 8x8 --out "$folder/out" --quiet)
# What is drawn, but hardly as it was meant, is reported.
warns() {
  local what=$1 pattern=$2; shift 2
  "$@" > "$folder/stdout" 2> "$folder/stderr" && [ "$(wc -l < "$folder/stderr")" = 1 ] &&
    grep -qE -e "^raypool: warning: .*$pattern" "$folder/stderr" && return
  failures=$((failures + 1))
  echo "FAILED: $what: wanted a warning that matches '$pattern', got:"
  cat "$folder/stderr"
}
printf 'v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n' > "$folder/crossing.obj"
warns "eye that sees nothing" "all black: no ray from the eye hits" "${sim[@]}" --scene "$folder/good.obj" --eye 0,0,5 \
  --look-at 0,0,9
printf 'v 0 0 0\nv 1 1 0\nv 2 2 0\nf 1 2 3\nf 2 2 2\n' > "$folder/line.obj"
warns "triangles without area, and no view" "all black: no triangle of the scene has an area" "${sim[@]}" \
  --scene "$folder/line.obj"
warns "light behind the walls" "all black: no light reaches" "${sim[@]}" --scene cornell --light 0,1000,0
warns "face that crosses itself" "crossing.obj:5: the face crosses itself" "${sim[@]}" --scene "$folder/crossing.obj"

[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
