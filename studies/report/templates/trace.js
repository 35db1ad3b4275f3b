/* A trace: {from, to, alus, texts, tracks: [{name, port, spans, kernels}]}. A span of a warp is [issued, granted,
   retired, ALU, text, wanted, threads], of a port [from, to, waits, text, unit]; a kernel is [from, to, text]. */
(function () {
  const ROW = 20, BAR = 12, HEAD = 22, LEFT = 128, LEAST = 20;

  const draw = (place) => {
    const trace = JSON.parse(document.getElementById(place.dataset.trace).textContent);
    const canvas = place.querySelector("canvas"), under = place.querySelector(".under");
    const said = place.querySelector("output");
    const most = Math.max(trace.to - trace.from, LEAST);
    const height = HEAD + ROW * trace.tracks.length;
    let first = trace.from + Math.min(most / 2, Math.max(0, most - 300)), cycles = Math.min(most, 300);
    let width = 0, asked = false;

    const colours = () => {
      const style = getComputedStyle(document.documentElement);
      return (name) => style.getPropertyValue("--" + name).trim();
    };
    const x = (cycle) => LEFT + (cycle - first) / cycles * (width - LEFT);
    /* The first span that ends behind this cycle: they are in the order of their ends. */
    const begin = (spans, end, cycle) => {
      let low = 0, high = spans.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (spans[middle][end] <= cycle) low = middle + 1; else high = middle;
      }
      return low;
    };
    const step = () => {
      const wanted = cycles / Math.max(2, (width - LEFT) / 90);
      const power = Math.pow(10, Math.floor(Math.log10(wanted)));
      return Math.max(1, [1, 2, 5, 10].find((n) => n * power >= wanted) * power);
    };

    const paint = () => {
      asked = false;
      const ratio = window.devicePixelRatio || 1;
      width = canvas.clientWidth;
      canvas.style.height = height + "px";
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const c = canvas.getContext("2d"), colour = colours();
      c.scale(ratio, ratio);
      c.font = "12px system-ui, sans-serif";
      c.textBaseline = "middle";
      const bar = (from, to, y, high, fill, alpha) => {
        const a = Math.max(LEFT, x(from)), b = Math.min(width, x(to));
        if (b <= a) return;
        c.globalAlpha = alpha;
        c.fillStyle = fill;
        c.fillRect(a, y, Math.max(b - a - (b - a > 3 ? 1 : 0), .6), high);
        c.globalAlpha = 1;
      };
      c.fillStyle = colour("muted");
      c.strokeStyle = colour("line");
      for (let at = Math.ceil(first / step()) * step(); at <= first + cycles; at += step()) {
        c.fillRect(x(at), HEAD - 4, 1, 4);
        c.beginPath();
        c.moveTo(x(at) + .5, HEAD);
        c.lineTo(x(at) + .5, height);
        c.stroke();
        const words = at.toLocaleString("en");
        if (x(at) + c.measureText(words).width < width) c.fillText(words, x(at) + 2, 9);
      }
      trace.tracks.forEach((track, row) => {
        const y = HEAD + row * ROW;
        c.fillStyle = colour("ink");
        c.fillText(track.name, 0, y + ROW / 2);
        const spans = track.spans;
        if (track.port) {
          for (let i = begin(spans, 1, first); i < spans.length && spans[i][0] < first + cycles; ++i)
            bar(spans[i][0], spans[i][1], y + 4, BAR, colour(spans[i][2] ? "idle1" : "other"), 1);
          return;
        }
        for (let i = begin(track.kernels, 1, first); i < track.kernels.length && track.kernels[i][0] < first + cycles; ++i)
          bar(track.kernels[i][0], track.kernels[i][1], y + ROW / 2 - 1, 2, colour("fetch"), 1);
        for (let i = begin(spans, 2, first); i < spans.length && spans[i][0] < first + cycles; ++i) {
          const [issued, granted, retired, alu] = spans[i];
          bar(issued, granted, y + 4, BAR, colour("paper"), 1);
          bar(issued, granted, y + 4, BAR, colour(trace.alus[alu]), .4);
          bar(granted, retired, y + 4, BAR, colour(trace.alus[alu]), 1);
        }
      });
      said.textContent = Math.round(cycles).toLocaleString("en") + " cycles from " +
        Math.round(first).toLocaleString("en");
    };
    const later = () => {
      if (asked) return;
      asked = true;
      requestAnimationFrame(paint);
    };
    const look = (from, count) => {
      cycles = Math.min(most, Math.max(LEAST, count));
      first = Math.min(trace.to - cycles, Math.max(trace.from, from));
      later();
    };
    const closer = (factor, at) => look(at - (at - first) * factor, cycles * factor);

    const plural = (count, word) => count + " " + word + (count === 1 ? "" : "s");
    const text_at = (offsetX, offsetY) => {
      const track = trace.tracks[Math.floor((offsetY - HEAD) / ROW)];
      const cycle = first + (offsetX - LEFT) / (width - LEFT) * cycles;
      if (!track || offsetX < LEFT) return "";
      const where = track.name + ", cycle " + Math.floor(cycle).toLocaleString("en") + ": ";
      const span = track.spans[begin(track.spans, track.port ? 1 : 2, cycle)];
      if (track.port) {
        if (!span || span[0] > cycle) return where + "nothing";
        return where + trace.texts[span[3]] + " of unit " + span[4] + (span[2] ? ", waits" : "");
      }
      const kernel = track.kernels[begin(track.kernels, 1, cycle)];
      const runs = kernel && kernel[0] <= cycle ? trace.texts[kernel[2]] : "no kernel";
      if (!span || span[0] > cycle) return where + runs + (kernel && kernel[0] <= cycle ? ", waits for its next instruction" : "");
      const [issued, granted, retired, alu, text, wanted, threads] = span;
      return where + runs + ", " + trace.texts[text] + " (" + trace.alus[alu] + ", " + plural(threads, "thread") + "): " +
        plural(Math.max(0, issued - wanted), "cycle") + " to be fetched, " + plural(granted - issued, "cycle") +
        " to get the ALU, " + plural(retired - granted, "cycle") + " in it";
    };

    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      closer(event.deltaY > 0 ? 1.25 : .8, first + (event.offsetX - LEFT) / (width - LEFT) * cycles);
    }, { passive: false });
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = { x: event.offsetX, first: first };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointerup", () => { held = null; });
    canvas.addEventListener("pointermove", (event) => {
      if (held) look(held.first - (event.offsetX - held.x) / (width - LEFT) * cycles, cycles);
      under.textContent = text_at(event.offsetX, event.offsetY) || "\u00a0";
    });
    const doing = {
      in: () => closer(.5, first + cycles / 2), out: () => closer(2, first + cycles / 2),
      left: () => look(first - cycles / 2, cycles), right: () => look(first + cycles / 2, cycles),
      all: () => look(trace.from, most),
    };
    place.querySelectorAll("button").forEach((button) => button.addEventListener("click", doing[button.dataset.do]));
    const keys = { ArrowLeft: "left", ArrowRight: "right", "+": "in", "-": "out" };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key]) return;
      event.preventDefault();
      doing[keys[event.key]]();
    });
    window.addEventListener("resize", later);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", later);
    paint();
  };
  document.querySelectorAll(".drawing").forEach(draw);
})();
