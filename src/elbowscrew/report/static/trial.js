// The view in space: drawn on a plain canvas, so that it needs neither a library nor a graphics card.
(() => {
  const scene = JSON.parse(document.getElementById("data").textContent);
  if (!scene) return; // there are orientations alone
  const viewer = document.getElementById("viewer");
  const canvas = document.getElementById("space");
  const context = canvas.getContext("2d");
  if (!context) return;
  viewer.hidden = false;
  const play = document.getElementById("play");
  const scrub = document.getElementById("scrub");
  const speed = document.getElementById("speed");
  const readout = document.getElementById("readout");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => times(1 / Math.hypot(...a), a);

  // A pose is the displacement since the reference: a point p of the distal body there is at q p q* + d now.
  const moved = (k, p) => {
    const q = scene.turn[k];
    const d = scene.shift[k];
    if (!q || !d) return null;
    const v = [q[1], q[2], q[3]];
    const t = times(2, cross(v, p));
    return add(add(p, d), add(times(q[0], t), cross(v, t)));
  };
  const last = scene.frame.length - 1;
  const path = scene.frame.map((_, k) => moved(k, scene.distal.origin));
  const foot = (p) => add(scene.center, times(dot(less(p, scene.center), scene.direction), scene.direction));

  // Colors of the page, looked up once for each picture; on dark paper the scale of the angle is lighter, as in the charts.
  let colors = {};
  const color = (name) => (colors[name] ??= page.color(`--${name}`));
  const lighter = (hex) => `rgb(${[1, 3, 5].map((k) => Math.min((0.55 * (parseInt(hex.slice(k, k + 2), 16) - 127.5) + 127.5) * 1.5, 255)).join(" ")})`;
  const colorAt = (theta) => {
    const [low, high] = scene.thetaRange;
    const place = Math.min(Math.max((theta - low) / (high - low || 1), 0), 1) * (scene.colors.length - 1);
    const found = scene.colors[Math.round(place)];
    return page.isDark() ? lighter(found) : found;
  };

  const everything = [...path, ...scene.distal.markers, ...(scene.proximal ? [scene.proximal.origin, ...scene.proximal.markers] : [])]
    .filter(Boolean);
  everything.push(add(scene.center, times(scene.half, scene.direction)), less(scene.center, times(scene.half, scene.direction)));
  const far = (points) => points.reduce((most, p) => Math.max(most, Math.hypot(...less(p, scene.center))), 0);
  const bones = scene.bones.map((bone) => ({
    ...bone,
    points: Array.from({ length: bone.vertices.length / 3 }, (_, k) => bone.vertices.slice(3 * k, 3 * k + 3)),
  }));
  // A bone is shown whole unless it goes twice as far as all else.
  const reach = Math.max(far(everything), Math.min(2 * far(everything), ...(bones.length ? [far(bones.flatMap((bone) => bone.points))] : [0])));

  // Which way is up: toward the proximal body if it is known, else away from the middle of the distal one's path.
  const known = path.filter(Boolean);
  const middle = times(1 / known.length, known.reduce(add, [0, 0, 0]));
  const upright = () => {
    const toward = scene.proximal ? less(scene.proximal.origin, scene.center) : less(scene.center, middle);
    const flat = less(toward, times(dot(toward, scene.direction), scene.direction));
    return Math.hypot(...flat) > 1e-6 * reach ? unit(flat) : scene.across[1];
  };
  const view = { rows: null, zoom: 1, frame: 0, playing: false };
  const turned = (rows, angle, axis) => {
    const c = Math.cos(angle);
    const s = Math.sin(angle);
    const [r0, r1, r2] = rows;
    return axis === "up"
      ? [add(times(c, r0), times(s, r2)), r1, less(times(c, r2), times(s, r0))]
      : [r0, less(times(c, r1), times(s, r2)), add(times(c, r2), times(s, r1))];
  };
  const look = (name) => {
    const up = upright();
    const toViewer = scene.direction;
    const right = cross(up, toViewer);
    let rows = [right, up, toViewer];
    if (name === "side") rows = turned(rows, Math.PI / 2, "up");
    if (name === "oblique") rows = turned(turned(rows, -0.62, "up"), -0.3, "across");
    view.rows = rows;
  };

  const shown = (name) => viewer.querySelector(`[data-show="${name}"]`)?.checked ?? false;
  const tellState = () => {
    viewer.dataset.view = view.rows.flat().map((x) => x.toFixed(4)).join(" ");
    viewer.dataset.zoom = view.zoom.toFixed(3);
    viewer.dataset.frame = String(scene.frame[view.frame]);
    viewer.dataset.playing = String(view.playing);
  };
  const number = (value, digits) => (value === null ? "–" : value.toFixed(digits).replace("-", "−"));
  const tellFrame = () => {
    const k = view.frame;
    const text = `Frame ${scene.frame[k]} · ${number(scene.time[k], 2)} s · θ ${number(scene.theta[k], 1)} deg · slide ${number(scene.slide[k], 2)} mm`;
    readout.textContent = text + (scene.turn[k] ? (scene.valid[k] ? "" : " · filled in") : " · not tracked");
    scrub.value = String(k);
    scrub.setAttribute("aria-valuetext", `frame ${scene.frame[k]}, ${number(scene.theta[k], 1)} degrees`);
  };

  let scale = 1;
  let width = 1;
  let height = 1;
  const screen = (p) => {
    const q = less(p, scene.center);
    return [width / 2 + scale * dot(view.rows[0], q), height / 2 - scale * dot(view.rows[1], q), dot(view.rows[2], q)];
  };
  const line = (points, look, thick, alpha = 1) => {
    context.strokeStyle = look;
    context.lineWidth = thick;
    context.globalAlpha = alpha;
    context.beginPath();
    let open = false;
    for (const p of points) {
      if (!p) { open = false; continue; }
      const [x, y] = screen(p);
      if (open) context.lineTo(x, y); else context.moveTo(x, y);
      open = true;
    }
    context.stroke();
    context.globalAlpha = 1;
  };
  const disc = (p, radius, look) => {
    const [x, y] = screen(p);
    context.fillStyle = look;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
    context.strokeStyle = color("paper");
    context.lineWidth = 1;
    context.stroke();
  };
  // Few markers are joined each to each, many to the body's origin.
  const joined = (points, origin) => (points.length < 5
    ? points.flatMap((p, k) => points.slice(k + 1).flatMap((q) => [p, q, null]))
    : points.flatMap((p) => [origin, p, null]));
  const around = 36;
  const surface = (about, region, look, alpha) => {
    if (!region) return;
    const [angle, radius] = region;
    const steps = 12;
    const ring = (s) => {
      const wide = Math.hypot(radius, Math.tan(Math.min(angle, 1.4)) * s);
      return Array.from({ length: around }, (_, k) => {
        const turn = (2 * Math.PI * k) / around;
        const out = add(times(wide * Math.cos(turn), about.across[0]), times(wide * Math.sin(turn), about.across[1]));
        return screen(add(add(about.center, times(s, about.direction)), out));
      });
    };
    context.fillStyle = look;
    context.globalAlpha = alpha;
    let before = null;
    for (let j = 0; j <= steps; j += 1) {
      const now = ring(about.half * ((2 * j) / steps - 1));
      if (before) {
        for (let k = 0; k < around; k += 1) {
          const next = (k + 1) % around;
          context.beginPath();
          context.moveTo(before[k][0], before[k][1]);
          context.lineTo(before[next][0], before[next][1]);
          context.lineTo(now[next][0], now[next][1]);
          context.lineTo(now[k][0], now[k][1]);
          context.closePath();
          context.fill();
        }
      }
      before = now;
    }
    context.globalAlpha = 1;
  };
  const ends = (axis, share) => [-1, 1].map((way) => add(axis.center, times(way * share * axis.half, axis.direction)));
  // The second axis goes with the distal body.
  const ownAxes = (k) => scene.joint.axes.flatMap((axis, j) => {
    const look = color(`axis${j + 1}`);
    if (!axis.moves) return [{ ...axis, look }];
    const at = moved(k, axis.center);
    if (!at) return [];
    const led = (v) => less(moved(k, add(axis.center, v)), at);
    return [{ ...axis, look, center: at, direction: led(axis.direction), across: axis.across.map(led) }];
  });
  // Bones: flat triangles from back to front, each as light as it faces the viewer; lines are drawn over them.
  const channels = (name) => {
    const text = color(name);
    return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
  };
  const drawBones = (k) => {
    const faces = [];
    const paper = channels("paper");
    bones.forEach((bone) => {
      const own = channels(bone.of);
      const at = bone.points.map((p) => (bone.of === "distal" ? moved(k, p) : p)).map((p) => p && screen(p));
      for (let j = 0; j < bone.faces.length; j += 3) {
        const [a, b, c] = [at[bone.faces[j]], at[bone.faces[j + 1]], at[bone.faces[j + 2]]];
        if (!a || !b || !c) return;
        const [u, v] = [[b[0] - a[0], b[1] - a[1], scale * (b[2] - a[2])], [c[0] - a[0], c[1] - a[1], scale * (c[2] - a[2])]];
        const across = cross(u, v);
        const facing = Math.abs(across[2]) / (Math.hypot(...across) || 1);
        faces.push({ a, b, c, depth: a[2] + b[2] + c[2], own, facing });
      }
    });
    faces.sort((one, other) => one.depth - other.depth);
    faces.forEach(({ a, b, c, own, facing }) => {
      const share = page.isDark() ? 0.15 + 0.45 * facing : 0.65 - 0.45 * facing;
      const look = `rgb(${own.map((x, n) => Math.round(paper[n] + share * (x - paper[n]))).join(" ")})`;
      context.fillStyle = look;
      context.strokeStyle = look;
      context.lineWidth = 0.7;
      context.beginPath();
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
      context.lineTo(c[0], c[1]);
      context.closePath();
      context.fill();
      context.stroke();
    });
  };
  const center = () => {
    if (!scene.joint.center) return;
    if (shown("cone") && scene.joint.semiAxes) {
      // Outline of an ellipsoid: C d / sqrt(d C d) in all directions d, C the sum of its semi-axes' squares as seen.
      const seen = scene.joint.semiAxes.map((a) => [scale * dot(view.rows[0], a), scale * dot(view.rows[1], a)]);
      const square = [0, 1].map((i) => [0, 1].map((j) => seen.reduce((sum, a) => sum + a[i] * a[j], 0)));
      const [x, y] = screen(scene.joint.center);
      context.fillStyle = color("distal");
      context.globalAlpha = 0.25;
      context.beginPath();
      for (let n = 0; n < around; n += 1) {
        const d = [Math.cos((2 * Math.PI * n) / around), Math.sin((2 * Math.PI * n) / around)];
        const out = square.map((row) => row[0] * d[0] + row[1] * d[1]);
        const size = Math.sqrt(out[0] * d[0] + out[1] * d[1]) || 1;
        context.lineTo(x + out[0] / size, y - out[1] / size);
      }
      context.fill();
      context.globalAlpha = 1;
    }
    disc(scene.joint.center, 4.5, color("measured"));
    label(add(scene.joint.center, times(16 / scale, view.rows[1])), "center", color("measured"));
  };
  const label = (p, text, look) => {
    context.font = "600 13px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    // A word that would be cut off at the edge moves inside; one whose place is out of view stays there.
    const at = screen(p);
    const half = [context.measureText(text).width / 2 + 3, 10];
    const [x, y] = [width, height].map((size, k) => {
      const inside = Math.min(Math.max(at[k], half[k]), size - half[k]);
      return Math.abs(inside - at[k]) < half[k] + 8 ? inside : at[k];
    });
    context.lineWidth = 3;
    context.strokeStyle = color("paper");
    context.strokeText(text, x, y);
    context.fillStyle = look;
    context.fillText(text, x, y);
  };
  const triad = () => {
    // Directions of the frame the axes are written in, in a corner.
    const size = 34;
    const origin = [48, height - 48];
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    ["x", "y", "z"].forEach((name, k) => {
      const right = view.rows[0][k];
      const up = view.rows[1][k];
      context.strokeStyle = color("soft");
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(...origin);
      context.lineTo(origin[0] + size * right, origin[1] - size * up);
      context.stroke();
      context.fillStyle = color("ink");
      context.fillText(name, origin[0] + (size + 9) * right, origin[1] - (size + 9) * up);
    });
  };
  const ruler = () => {
    const wanted = (0.2 * width) / scale;
    const size = 10 ** Math.floor(Math.log10(wanted));
    const length = [5, 2, 1].map((k) => k * size).find((value) => value <= wanted);
    const [x, y] = [width - 24, height - 26];
    context.strokeStyle = color("ink");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - length * scale, y);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "right";
    context.fillStyle = color("ink");
    context.fillText(`${length} mm`, x, y - 10);
  };

  const draw = (ratio = window.devicePixelRatio || 1) => {
    colors = {};
    width = canvas.clientWidth || 1;
    height = canvas.clientHeight || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineCap = "round";
    context.lineJoin = "round";
    scale = (0.46 * Math.min(width, height) * view.zoom) / reach;
    const k = view.frame;
    const here = path[k];
    if (shown("bones")) drawBones(k);
    const boneOf = (end) => shown("bones") && bones.some((bone) => bone.of === end);
    if (scene.proximal && !boneOf("proximal")) line([scene.proximal.origin, foot(scene.proximal.origin)], color("limb"), 9, 0.3);
    if (here && !boneOf("distal")) line([here, foot(here)], color("limb"), 9, 0.3);
    if (shown("cone")) surface(scene, scene.spread, color("region"), 0.1);
    if (shown("axes")) {
      scene.segments.forEach((s, j) => line([s.slice(0, 3), s.slice(3)], colorAt(scene.segmentTheta[j]), 1, 0.7));
    }
    if (shown("cone")) surface(scene, scene.confidence, color("distal"), 0.25);
    const own = ownAxes(k);
    // Where the joint has axes of its own, or a center, the mean of the frames' axes is none of them.
    if (!own.length && !scene.joint.center) line(ends(scene, 1.15), color("measured"), 2.4);
    own.forEach((axis) => {
      if (shown("cone")) surface(axis, axis.known, color("distal"), 0.25);
      line(ends(axis, 1), axis.look, 2.4);
      label(ends(axis, 1.06)[1], axis.name, color("ink"));
    });
    if (shown("path")) line(path, color("distal"), 2);
    if (shown("moment") && scene.axis[k] && scene.point[k]) {
      const n = scene.axis[k];
      const near = add(scene.point[k], times(dot(less(scene.center, scene.point[k]), n), n));
      const ends = [less(near, times(1.1 * scene.half, n)), add(near, times(1.1 * scene.half, n))];
      line(ends, color("paper"), 6, 0.8);
      line(ends, colorAt(scene.theta[k]), 3.5);
    }
    if (scene.proximal) {
      line(joined(scene.proximal.markers, scene.proximal.origin), color("proximal"), 1, 0.5);
      scene.proximal.markers.forEach((p) => disc(p, 4, color("proximal")));
      disc(scene.proximal.origin, 5.5, color("proximal"));
      label(add(scene.proximal.origin, times(18 / scale, view.rows[1])), scene.proximal.word, color("proximal-text"));
    }
    if (here) {
      const markers = scene.distal.markers.map((p) => moved(k, p));
      line(joined(markers, here), color("distal"), 1, 0.6);
      markers.forEach((p) => disc(p, 4, color("distal")));
      disc(here, 5.5, color("distal"));
      label(add(here, times(18 / scale, view.rows[1])), scene.distal.word, color("distal-text"));
    }
    center();
    triad();
    ruler();
    tellState();
  };

  let waiting = false;
  const redraw = () => {
    if (waiting) return;
    waiting = true;
    window.requestAnimationFrame(() => { waiting = false; draw(); });
  };
  const goTo = (k) => {
    view.frame = Math.min(Math.max(k, 0), last);
    tellFrame();
    redraw();
  };

  // Real time; where motion is to be reduced, two steps a second.
  let started = 0;
  let from = 0;
  const tick = (now) => {
    if (!view.playing) return;
    const elapsed = calm.matches ? Math.floor((now - started) / 500) * 0.5 : (now - started) / 1000;
    const wanted = from + elapsed * Number(speed.value);
    if (wanted >= scene.time[last]) { goTo(last); setPlaying(false); return; }
    let k = view.frame;
    while (k < last && scene.time[k + 1] <= wanted) k += 1;
    if (k !== view.frame) goTo(k);
    window.requestAnimationFrame(tick);
  };
  const setPlaying = (playing) => {
    view.playing = playing;
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(playing));
    if (playing) {
      if (view.frame === last) goTo(0);
      started = performance.now();
      from = scene.time[view.frame];
      window.requestAnimationFrame(tick);
    }
    redraw();
  };
  const zoom = (factor) => { view.zoom = Math.min(Math.max(view.zoom * factor, 0.2), 60); redraw(); };
  const turn = (right, down) => {
    view.rows = turned(turned(view.rows, -right, "up"), down, "across").map(unit);
    redraw();
  };

  play.addEventListener("click", () => setPlaying(!view.playing));
  // A still as it is seen, at a printer's resolution and in the colors of paper.
  document.getElementById("still").addEventListener("click", () => {
    const still = document.createElement("canvas");
    page.onPaper(() => {
      draw(Math.max(3, window.devicePixelRatio));
      [still.width, still.height] = [canvas.width, canvas.height];
      const ink = still.getContext("2d");
      ink.fillStyle = color("paper");
      ink.fillRect(0, 0, still.width, still.height);
      ink.drawImage(canvas, 0, 0);
    });
    draw();
    still.toBlob((blob) => page.save(`frame-${scene.frame[view.frame]}.png`, blob), "image/png");
  });
  scrub.max = String(last);
  scrub.addEventListener("input", () => { setPlaying(false); goTo(Number(scrub.value)); });
  speed.addEventListener("change", () => { started = performance.now(); from = scene.time[view.frame]; });
  viewer.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    if (button.dataset.view) { look(button.dataset.view); view.zoom = 1; redraw(); }
    if (button.dataset.zoom) zoom(Number(button.dataset.zoom));
  });
  viewer.addEventListener("change", (event) => { if (event.target.dataset.show) redraw(); });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) turn(event.movementX * 0.01, event.movementY * 0.01);
  });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(-0.002 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = 0.1;
    const turns = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    if (turns[event.key]) turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") zoom(1.25);
    else if (event.key === "-") zoom(0.8);
    else if (event.key === " ") setPlaying(!view.playing);
    else return;
    event.preventDefault();
  });
  new ResizeObserver(redraw).observe(canvas);
  page.dark.addEventListener("change", redraw);
  window.addEventListener("beforeprint", () => draw());
  window.addEventListener("afterprint", redraw);
  look("oblique");
  // Begin where the angle is largest: there the motion shows.
  goTo(scene.theta.reduce((best, theta, k) => (theta !== null && theta > (scene.theta[best] ?? -Infinity) ? k : best), 0));
  draw();
})();
