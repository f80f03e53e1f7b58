// Both collapses in one WebGL2 canvas: FE left, MBS right, or one over the other. No library.
// The formats read here are described in src/report/scene.rs and src/report/codec.rs; the shaders are in shaders.js.
"use strict";
(() => {
  const $ = (id) => document.getElementById(id);
  const head = JSON.parse($("scene-head").textContent);
  const canvas = $("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, preserveDrawingBuffer: true });
  const giveUp = (why) => {
    $("fallback").textContent = `${why} The figures, plots and tables of this page are complete without it.`;
    $("fallback").hidden = false;
    canvas.style.cssText = "visibility: hidden; min-height: 0; height: 130px";
    document.querySelectorAll(".transport, .options, .keys, .hint, .tag, .clock, .axes").forEach((e) => (e.hidden = true, e.style.display = "none"));
  };
  if (!gl) return giveUp("This browser offers no WebGL2, so the 3D view cannot be shown.");
  const { times, fe, mbs } = head;
  if (!times.length || (!fe && !mbs)) return giveUp("The runs recorded no frames, so there is no 3D view.");

  // ---- data ---------------------------------------------------------------------------------------------
  const raw = atob($("scene-data").textContent.trim());
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  const block = ([from, length]) => bytes.slice(from, from + length);
  const reader = (data) => {
    let at = 0;
    return () => {
      let value = 0;
      for (let shift = 0; ; shift += 7) {
        const b = data[at++];
        value |= (b & 127) << shift;
        if (b < 128) return value;
      }
    };
  };
  const frames = times.length;
  if (fe) {
    const next = reader(block(fe.positions));
    fe.q = new Uint16Array(frames * fe.nodes * 3);
    for (let node = 0; node < fe.nodes; node++) {
      for (let axis = 0; axis < 3; axis++) {
        let last = 0, before = 0;
        for (let f = 0; f < frames; f++) {
          const z = next();
          const value = (f < 2 ? last : 2 * last - before) + ((z >>> 1) ^ -(z & 1));
          fe.q[(f * fe.nodes + node) * 3 + axis] = value;
          before = last;
          last = value;
        }
      }
    }
    fe.faceData = block(fe.faces);
    fe.faceCount = fe.faceData.length / 24;
    const table = block(fe.elements).buffer;
    fe.elementCount = table.byteLength / 8;
    const deaths = new Float32Array(table), parts = new Uint32Array(table);
    fe.elementTexels = new Float32Array(4 * 1024 * Math.max(1, Math.ceil(fe.elementCount / 1024)));
    for (let e = 0; e < fe.elementCount; e++) {
      const part = parts[2 * e + 1];
      fe.elementTexels.set([deaths[2 * e], fe.parts[part][1], 0, ((part * 7) % 5) / 4 - 0.5], 4 * e);
    }
    if (fe.strain) {
      // Changes expanded to one byte a frame and element.
      const read = reader(block(fe.strain.data));
      fe.strainBytes = new Uint8Array(frames * fe.elementCount);
      for (let e = 0; e < fe.elementCount; e++) {
        let frame = 0;
        for (let n = read(); n > 0; n--) {
          frame += read();
          const value = read();
          for (let f = frame; f < frames; f++) fe.strainBytes[f * fe.elementCount + e] = value;
        }
      }
    }
    fe.texels = new Float32Array(4 * 1024 * Math.max(1, Math.ceil(fe.nodes / 1024)));
  }
  if (mbs) {
    mbs.p = new Float32Array(block(mbs.poses).buffer);
    mbs.boxes = mbs.bodies.flatMap((b, body) => b.boxes.map(([center, half]) => ({ body, center, half, crushed: [] })));
    for (const c of mbs.crushed) {
      mbs.boxes.filter((x) => x.body === c.place[0])[c.place[1]].crushed.push(c);
    }
  }

  // ---- small vector and matrix helpers (column-major) ------------------------------------------------------
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
  const multiply = (a, b) => {
    const m = new Float32Array(16);
    for (let c = 0; c < 4; c++) for (let r = 0; r < 4; r++) for (let k = 0; k < 4; k++) m[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    return m;
  };
  const turn = ([w, x, y, z], v) => {
    const t = cross([x, y, z], v).map((c) => 2 * c);
    const u = cross([x, y, z], t);
    return [0, 1, 2].map((i) => v[i] + w * t[i] + u[i]);
  };

  // ---- shaders ----------------------------------------------------------------------------------------------
  const program = ([vertex, fragment]) => {
    const p = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const s = gl.createShader(type);
      gl.shaderSource(s, source);
      gl.compileShader(s);
      if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
      gl.attachShader(p, s);
    }
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
    const at = {};
    for (let i = gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS) - 1; i >= 0; i--) {
      const { name } = gl.getActiveUniform(p, i);
      at[name] = gl.getUniformLocation(p, name);
    }
    return { p, at };
  };
  const programs = {};
  try {
    for (const name in SHADERS) programs[name] = program(SHADERS[name]);
  } catch (error) {
    return giveUp(`The 3D view could not be started (${error.message.trim()}).`);
  }
  const buffer = (data, usage = gl.STATIC_DRAW) => {
    const b = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, b);
    gl.bufferData(gl.ARRAY_BUFFER, data, usage);
    return b;
  };
  const attribute = (at, size, stride, offset, divisor, type = gl.FLOAT) => {
    gl.enableVertexAttribArray(at);
    if (type === gl.FLOAT) gl.vertexAttribPointer(at, size, type, false, stride, offset);
    else gl.vertexAttribIPointer(at, size, type, stride, offset);
    gl.vertexAttribDivisor(at, divisor);
  };
  const texture = (data) => {
    const t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, 1024, data.length / 4096);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return t;
  };
  const upload = (t, data) => {
    gl.bindTexture(gl.TEXTURE_2D, t);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 1024, data.length / 4096, gl.RGBA, gl.FLOAT, data);
  };

  // ---- geometry on the card -----------------------------------------------------------------------------------
  if (fe) {
    fe.vao = gl.createVertexArray();
    gl.bindVertexArray(fe.vao);
    buffer(fe.faceData);
    attribute(0, 4, 24, 0, 1, gl.UNSIGNED_INT);
    attribute(1, 1, 24, 16, 1, gl.UNSIGNED_INT);
    attribute(2, 1, 24, 20, 1);
    fe.positionTexture = texture(fe.texels);
    fe.elementTexture = texture(fe.elementTexels);
  }
  const cube = [];
  for (let axis = 0; axis < 3; axis++) for (const side of [-1, 1]) for (const k of [0, 1, 2, 0, 2, 3]) {
    const [u, v] = [[0, 0], [1, 0], [1, 1], [0, 1]][k];
    const p = [0, 0, 0];
    p[axis] = side;
    p[(axis + 1) % 3] = 2 * u - 1;
    p[(axis + 2) % 3] = 2 * v - 1;
    cube.push(...p, u, v);
  }
  const cubeBuffer = buffer(new Float32Array(cube));
  const boxSet = () => {
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, cubeBuffer);
    attribute(0, 3, 20, 0, 0);
    attribute(1, 2, 20, 12, 0);
    const instances = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    [[2, 4, 0], [3, 3, 16], [4, 3, 28], [5, 2, 40]].forEach(([at, size, offset]) => attribute(at, size, 48, offset, 1));
    return { vao, instances, count: 0 };
  };
  const fill = (set, list) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, set.instances);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(list), gl.DYNAMIC_DRAW);
    set.count = list.length / 12;
  };
  const bodies = boxSet(), obstacles = boxSet(), fixed = boxSet();
  const still = (list) => list.flatMap((o) => [1, 0, 0, 0, ...o.center, ...o.half, -1, 0]);
  fill(obstacles, still(head.obstacles));
  fill(fixed, still(mbs ? mbs.fixed : []));
  const floor = gl.createVertexArray();
  gl.bindVertexArray(floor);
  buffer(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
  attribute(0, 2, 8, 0, 0);
  const points = { vao: gl.createVertexArray() };
  gl.bindVertexArray(points.vao);
  points.buffer = buffer(new Float32Array(0), gl.DYNAMIC_DRAW);
  attribute(0, 3, 20, 0, 0);
  attribute(1, 2, 20, 12, 0);

  // ---- state ----------------------------------------------------------------------------------------------------
  const lower = head.view[0], upper = head.view[1];
  const centre = lower.map((v, i) => v + (i < 2 ? 0.5 : 0.4) * (upper[i] - v)); // debris lies low
  const radius = Math.max(1, 0.5 * Math.hypot(...sub(upper, lower)));
  const views = { oblique: [-0.62, 0.27], front: [-Math.PI / 2, 0.06], side: [0, 0.06], top: [-Math.PI / 2, 1.55] };
  const state = { t: times[0], playing: false, yaw: 0, pitch: 0, distance: 1, target: centre, layout: "split", colour: "part" };
  const lookFrom = (name) => Object.assign(state, { yaw: views[name][0], pitch: views[name][1], from: views[name], target: [...centre], distance: radius * 3.3 });
  lookFrom("oblique");
  const single = !fe || !mbs;
  if (single) {
    $("viewer").classList.add("single");
    document.querySelectorAll("[name=layout]").forEach((e) => (e.disabled = true));
    $(fe ? "tag-mbs" : "tag-fe").hidden = true;
  }

  // ---- the state at a time ----------------------------------------------------------------------------------------
  const locate = (t) => {
    let lo = 0, hi = frames - 1;
    while (hi - lo > 1) {
      const mid = (lo + hi) >> 1;
      if (times[mid] <= t) lo = mid; else hi = mid;
    }
    const width = times[hi] - times[lo];
    return [lo, hi, width > 0 ? Math.min(1, Math.max(0, (t - times[lo]) / width)) : 0];
  };
  const turned = (m) => m.mbsTime ?? m.live; // a latent section counts from when it goes live
  const kindOf = (m) => (m.fe === null ? 4 : m.fe && turned(m) !== null ? 0 : m.fe ? 1 : turned(m) !== null ? 2 : 3);
  let markersFe = [], markersMbs = [], chargesFe = [], chargesMbs = [];
  const update = () => {
    const [a, b, f] = locate(state.t);
    if (fe) {
      const { q, nodes, origin, step, texels } = fe;
      for (let i = 0; i < nodes; i++) {
        for (let k = 0; k < 3; k++) {
          const u = q[(a * nodes + i) * 3 + k], v = q[(b * nodes + i) * 3 + k];
          texels[4 * i + k] = origin[k] + (u + (v - u) * f) * step[k];
        }
      }
      upload(fe.positionTexture, texels);
      if (fe.strain) {
        const n = fe.elementCount, s = fe.strainBytes;
        for (let e = 0; e < n; e++) fe.elementTexels[4 * e + 2] = (s[a * n + e] + (s[b * n + e] - s[a * n + e]) * f) / 255;
      }
      upload(fe.elementTexture, fe.elementTexels);
    }
    const poses = [];
    if (mbs) {
      const moving = mbs.compounds[f >= 1 ? b : a];
      if (moving !== undefined) document.querySelector("#tag-mbs span").textContent = `${moving} rigid compound${moving === 1 ? "" : "s"}`;
      const n = mbs.bodies.length;
      for (let i = 0; i < n; i++) {
        const p = mbs.p.subarray((a * n + i) * 7, (a * n + i) * 7 + 7), r = mbs.p.subarray((b * n + i) * 7, (b * n + i) * 7 + 7);
        const sign = p[3] * r[3] + p[4] * r[4] + p[5] * r[5] + p[6] * r[6] < 0 ? -1 : 1;
        const at = [0, 1, 2].map((k) => p[k] + (r[k] - p[k]) * f);
        const turned = [3, 4, 5, 6].map((k) => p[k] + (sign * r[k] - p[k]) * f);
        const l = Math.hypot(...turned) || 1;
        poses.push([at, turned.map((c) => c / l)]);
      }
      // boxes are shorter by what has been crushed of them
      const shortened = ({ center, half, crushed }) => {
        if (crushed.length === 0) return [center, half];
        const [c, h] = [[...center], [...half]];
        for (const { axis, sign, depth } of crushed) {
          const s = depth[a] + (depth[b] - depth[a]) * f;
          c[axis] -= 0.5 * sign * s;
          h[axis] -= 0.5 * s;
        }
        return [c, h];
      };
      fill(bodies, mbs.boxes.flatMap((box) => {
        const { body } = box, [center, half] = shortened(box);
        const b = mbs.bodies[body];
        if ((b.appears !== null && state.t < b.appears) || (b.removed !== null && state.t > b.removed)) return [];
        const [at, q] = poses[body];
        const c = turn(q, center);
        return [...q, at[0] + c[0], at[1] + c[1], at[2] + c[2], ...half, b.group, ((body * 7) % 5) / 4 - 0.5];
      }));
    }
    // The nearest node carries a marker; its own distance from the node is kept.
    const atNode = (m) => [0, 1, 2].map((k) => m.point[k] + fe.texels[4 * m.node + k] - origin0(m.node, k));
    const inBody = (m) => {
      const [p, q] = poses[m.body], c = turn(q, m.local);
      return [p[0] + c[0], p[1] + c[1], p[2] + c[2]];
    };
    markersFe = [];
    markersMbs = [];
    for (const m of head.markers) {
      const kind = kindOf(m);
      if (m.gone !== null && state.t > m.gone) continue; // a charge took its member away
      if (fe && m.node !== null) markersFe.push({ m, kind, at: atNode(m), active: m.fe === true && (m.feTime === null || state.t >= m.feTime) });
      if (mbs && m.body !== null) markersMbs.push({ m, kind, at: inBody(m), active: turned(m) !== null && state.t >= turned(m) });
    }
    const waiting = head.charges.filter((c) => state.t <= c.time);
    const mark = (at) => (m) => ({ m, kind: 5, at: at(m), active: true });
    chargesFe = fe ? waiting.filter((c) => c.node !== null).map(mark(atNode)) : [];
    chargesMbs = mbs ? waiting.filter((c) => c.body !== null).map(mark(inBody)) : [];
  };
  const origin0 = (node, k) => fe.origin[k] + fe.q[node * 3 + k] * fe.step[k];

  // ---- drawing ------------------------------------------------------------------------------------------------------
  const directions = (yaw, pitch) => {
    const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    const right = unit(cross([0, 0, 1], back));
    return { back, right, up: cross(back, right) };
  };
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => centre.map((c, i) => ((k >> i) & 1 ? upper : lower)[i] - c));
  // Distance at which the whole box is visible from the last named view: that of the moment would change as one turns. At the top names and clock need room.
  const fitting = (aspect) => {
    const { back, right, up } = directions(...state.from), s = 1.06 / Math.tan(0.26), room = 2.2 * 36 / Math.max(200, canvas.clientHeight);
    const tall = (c) => Math.max(-dot(c, up), dot(c, up) * (1 + room));
    return Math.max(...corners.map((c) => dot(c, back) + s * Math.max(Math.abs(dot(c, right)) / aspect, tall(c))));
  };
  const camera = (aspect) => {
    const { yaw, pitch, distance, target } = state;
    const { back, right, up } = directions(yaw, pitch);
    // A narrow view steps back so that the building stays visible.
    const d = distance * Math.max(1, fitting(aspect) / (radius * 3.3));
    const eye = target.map((c, i) => c + back[i] * d);
    const view = new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    const near = Math.max(0.05, d - radius * 6), far = d + radius * 12, s = 1 / Math.tan(0.26);
    const projection = new Float32Array([s / aspect, 0, 0, 0, 0, s, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, (-2 * far * near) / (far - near), 0]);
    return { eye, right, up, d, matrix: multiply(projection, view) };
  };
  let theme = {};
  const readTheme = () => {
    const probe = document.createElement("i");
    document.body.append(probe);
    const colour = (name) => {
      probe.style.color = `var(${name})`;
      return getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map((v) => v / 255);
    };
    theme = { sky: colour("--sky"), floor: colour("--floor"), grid: colour("--s2"), mbs: colour("--mbs") };
    probe.remove();
    theme.grid = theme.floor.map((v, i) => v + (theme.grid[i] - v) * 0.4);
    theme.dark = theme.sky[0] < 0.5;
  };
  const light = unit([0.5, -0.45, 0.75]);
  const use = (name, view, mode, look) => {
    const { p, at } = programs[name];
    gl.useProgram(p);
    gl.uniformMatrix4fv(at.uView, false, view.matrix);
    gl.uniform3fv(at.uEye, view.eye);
    gl.uniform3fv(at.uLight, light);
    gl.uniform4f(at.uShadow, light[0] / light[2], light[1] / light[2], (head.ground ?? 0) + 0.004, 0);
    gl.uniform1i(at.uMode, mode);
    gl.uniform4fv(at.uTint, look.tint ?? [0, 0, 0, 0]);
    gl.uniform1f(at.uEdge, look.edge ?? 0);
    gl.uniform1f(at.uDark, theme.dark ? 1 : 0);
    return at;
  };
  const drawFe = (view, mode) => {
    if (!fe) return;
    const at = use("fe", view, mode, { edge: $("show-edges").checked ? 0.4 : 0 });
    gl.uniform1f(at.uTime, state.t);
    gl.uniform1f(at.uStrain, state.colour === "strain" ? 1 : 0);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, fe.elementTexture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, fe.positionTexture);
    gl.uniform1i(at.uPositions, 0);
    gl.uniform1i(at.uElements, 1);
    gl.bindVertexArray(fe.vao);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, fe.faceCount);
  };
  const drawBoxes = (view, set, mode, look) => {
    if (!set.count) return;
    const at = use("box", view, mode, look);
    gl.uniform1f(at.uPlain, state.colour === "strain" ? 1 : 0);
    gl.bindVertexArray(set.vao);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, 36, set.count);
  };
  const drawMarkers = (view, list) => {
    if (!list.length) return;
    const order = [...list].sort((a, b) => a.active - b.active);
    const waiting = order.filter((m) => !m.active).length;
    const { p, at } = programs.point;
    gl.useProgram(p);
    gl.uniformMatrix4fv(at.uView, false, view.matrix);
    gl.uniform3fv(at.uEye, view.eye);
    gl.uniform1f(at.uRatio, devicePixelRatio || 1);
    gl.bindVertexArray(points.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, points.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(order.flatMap((m) => [...m.at, m.kind, m.active ? 1 : 0])), gl.DYNAMIC_DRAW);
    // Sites at which nothing has happened are hidden by what is before them: hundreds would hide the building.
    gl.drawArrays(gl.POINTS, 0, waiting);
    gl.disable(gl.DEPTH_TEST);
    gl.drawArrays(gl.POINTS, waiting, order.length - waiting);
    gl.enable(gl.DEPTH_TEST);
  };
  const drawView = (x, y, width, height, withFe, withMbs) => {
    const view = camera(width / height);
    gl.viewport(x, y, width, height);
    gl.scissor(x, y, width, height);
    gl.clearColor(...theme.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    const edge = $("show-edges").checked ? 0.7 : 0;
    if (head.ground !== null) {
      const { p, at } = programs.floor;
      gl.useProgram(p);
      gl.uniformMatrix4fv(at.uView, false, view.matrix);
      gl.uniform4f(at.uArea, centre[0], centre[1], head.ground, radius * 4);
      gl.uniform3fv(at.uFloor, theme.floor);
      gl.uniform3fv(at.uGrid, theme.grid);
      gl.depthMask(false);
      gl.bindVertexArray(floor);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      // Each ground pixel takes the shadow once, however many faces cast it.
      gl.enable(gl.STENCIL_TEST);
      gl.stencilFunc(gl.EQUAL, 0, 255);
      gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
      if (withFe) drawFe(view, 1);
      if (withMbs && !withFe) [bodies, fixed].forEach((set) => drawBoxes(view, set, 1, {}));
      drawBoxes(view, obstacles, 1, {});
      gl.disable(gl.STENCIL_TEST);
      gl.depthMask(true);
    }
    drawBoxes(view, obstacles, 0, { edge: 0.7 });
    if (withFe) drawFe(view, 0);
    if (withMbs && withFe) {
      gl.depthMask(false);
      drawBoxes(view, bodies, 2, { tint: [...theme.mbs, 0.8] });
      gl.depthMask(true);
    } else if (withMbs) [bodies, fixed].forEach((set) => drawBoxes(view, set, 0, { edge }));
    const list = [
      ...($("show-markers").checked ? (withFe ? markersFe : markersMbs) : []),
      ...($("show-charges").checked ? (withFe ? chargesFe : chargesMbs) : []),
    ];
    drawMarkers(view, list);
    return { view, x, y, width, height, list };
  };
  // The axes as the view sees them, each drawn from the middle of the mark.
  const drawAxes = () => {
    const { right, up } = directions(state.yaw, state.pitch);
    const [lines, names] = ["line", "text"].map((kind) => $("axes").querySelectorAll(kind));
    for (let k = 0; k < 3; k++) {
      lines[k].setAttribute("x2", (20 * right[k]).toFixed(1));
      lines[k].setAttribute("y2", (-20 * up[k]).toFixed(1));
      names[k].setAttribute("x", (28 * right[k]).toFixed(1));
      names[k].setAttribute("y", (4 - 28 * up[k]).toFixed(1));
    }
  };
  let panes = [];
  const draw = () => {
    const ratio = devicePixelRatio || 1;
    const width = Math.max(2, Math.round(canvas.clientWidth * ratio)), height = Math.max(2, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    update();
    if (single || state.layout === "overlay") panes = [drawView(0, 0, width, height, !!fe, !!mbs)];
    else {
      const half = Math.floor(width / 2), gap = Math.max(1, Math.round(ratio));
      gl.disable(gl.SCISSOR_TEST);
      gl.clearColor(...theme.grid, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.enable(gl.SCISSOR_TEST);
      panes = [drawView(0, 0, half - gap, height, true, false), drawView(half, 0, width - half, height, false, true)];
    }
    drawAxes();
    $("clock").textContent = state.t.toFixed(3);
    $("time").value = state.t;
    $("time").setAttribute("aria-valuetext", `${state.t.toFixed(3)} seconds`);
    document.dispatchEvent(new CustomEvent("fallwerk:time", { detail: state.t }));
  };
  let asked = false, clockLast = 0;
  const redraw = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame((now) => {
      asked = false;
      if (state.playing) {
        state.t += Math.min(0.1, Math.max(0, (now - clockLast) / 1000)) * Number($("speed").value);
        clockLast = now;
        if (state.t >= times[frames - 1]) {
          state.t = times[frames - 1];
          play(false);
        } else redraw();
      }
      draw();
    });
  };

  // ---- controls -------------------------------------------------------------------------------------------------------
  const remember = () => {
    const parts = [`t=${state.t.toFixed(3)}`];
    if (state.layout === "overlay") parts.push("layout=overlay");
    if (state.colour === "strain") parts.push("colour=strain");
    try { history.replaceState(null, "", `#${parts.join("&")}`); } catch { /* a page opened in a sandbox keeps its address */ }
  };
  const play = (on) => {
    if (on && state.t >= times[frames - 1]) state.t = times[0];
    state.playing = on;
    clockLast = performance.now();
    $("play").textContent = on ? "Pause" : "Play";
    $("play").setAttribute("aria-pressed", String(on));
    if (on) redraw(); else remember();
  };
  const seek = (t) => {
    if (state.playing) play(false);
    state.t = Math.min(times[frames - 1], Math.max(times[0], t));
    redraw();
  };
  const go = (t) => { seek(t); remember(); };
  const choose = (name, value) => {
    const input = document.querySelector(`input[name=${name}][value=${value}]`);
    if (!input || input.disabled) return;
    input.checked = true;
    state[name] = value;
    $("viewer").classList.toggle("overlay", state.layout === "overlay");
    const strain = state.colour === "strain";
    if ($("key-strain")) $("key-strain").hidden = !strain;
    $("key-part").hidden = strain;
    redraw();
  };
  $("play").addEventListener("click", () => play(!state.playing));
  $("time").min = times[0];
  $("time").max = times[frames - 1];
  $("time").addEventListener("input", () => seek(Number($("time").value)));
  $("time").addEventListener("change", remember);
  for (const name of ["layout", "colour"]) {
    document.querySelectorAll(`input[name=${name}]`).forEach((e) => e.addEventListener("change", () => { choose(name, e.value); remember(); }));
  }
  for (const id of ["show-markers", "show-charges", "show-edges"]) $(id).addEventListener("change", redraw);
  $("show-markers").addEventListener("change", () => ($("key-markers").hidden = !$("show-markers").checked));
  document.querySelectorAll("[data-view]").forEach((b) => b.addEventListener("click", () => { lookFrom(b.dataset.view); redraw(); }));
  $("show-charges").addEventListener("change", () => ($("key-charges").hidden = !$("show-charges").checked));
  if (!head.markers.length) $("key-markers").hidden = true;
  if (!head.charges.length) $("key-charges").hidden = true;
  document.addEventListener("fallwerk:seek", (event) => go(event.detail));

  const pointers = new Map();
  const pan = (dx, dy) => {
    const { right, up, d } = camera(panes[0] ? panes[0].width / panes[0].height : 1);
    const k = (2 * Math.tan(0.26) * d) / canvas.clientHeight;
    state.target = state.target.map((c, i) => c - (right[i] * dx - up[i] * dy) * k);
  };
  const zoom = (factor) => (state.distance = Math.min(radius * 20, Math.max(radius * 0.15, state.distance * factor)));
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return hover(event);
    const now = [event.clientX, event.clientY];
    const [dx, dy] = [now[0] - last[0], now[1] - last[1]];
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const before = Math.hypot(last[0] - other[0], last[1] - other[1]), after = Math.hypot(now[0] - other[0], now[1] - other[1]);
      if (after > 0) zoom(before / after);
      pan(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) pan(dx, dy);
    else {
      state.yaw -= dx * 0.006;
      state.pitch = Math.min(1.55, Math.max(0.01, state.pitch + dy * 0.006));
    }
    pointers.set(event.pointerId, now);
    redraw();
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return; // the page scrolls until the view is clicked
    event.preventDefault();
    zoom(Math.exp(event.deltaY * 0.0012));
    redraw();
  }, { passive: false });
  canvas.addEventListener("pointerleave", () => ($("tip").hidden = true));
  const seconds = (t) => (t === null ? "\u2013" : `${t.toFixed(3)} s`);
  const hover = (event) => {
    const r = canvas.getBoundingClientRect(), ratio = canvas.width / r.width;
    const px = (event.clientX - r.left) * ratio, py = canvas.height - (event.clientY - r.top) * ratio;
    let best = null;
    for (const pane of panes) {
      for (const marker of pane.list) {
        const m = pane.view.matrix, p = marker.at;
        const clip = [0, 1, 3].map((k) => m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k]);
        const d = Math.hypot(pane.x + (0.5 + (0.5 * clip[0]) / clip[2]) * pane.width - px, pane.y + (0.5 + (0.5 * clip[1]) / clip[2]) * pane.height - py);
        if (clip[2] > 0 && d < 12 * ratio && (!best || d < best.d)) best = { d, m: marker.m };
      }
    }
    const tip = $("tip");
    tip.hidden = !best;
    if (!best) return;
    const { m } = best;
    const zone = !fe && m.fe === null ? "" : `\nFE zone: ${m.fe === null ? "not evaluated" : m.fe ? seconds(m.feTime) : "no"}`;
    tip.textContent = m.what !== undefined ? `charge ${m.label}: ${m.what}\nfires at ${seconds(m.time)}` : `${m.label}${zone}\n${m.latent ? `latent, goes live: ${seconds(m.live)}` : `MBS yields: ${!m.mbs ? "no hinge" : m.slight !== null ? `${seconds(m.slight)} (slightly)` : seconds(m.mbsTime)}`}${m.fractured === null ? "" : `\nseparates: ${seconds(m.fractured)}`}`;
    tip.style.left = `${Math.min(event.clientX - r.left + 14, r.width - 170)}px`;
    tip.style.top = `${Math.min(event.clientY - r.top + 14, r.height - 90)}px`;
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const frame = locate(state.t);
    const actions = {
      " ": () => play(!state.playing),
      ArrowRight: () => go(times[Math.min(frames - 1, frame[2] >= 1 ? frame[1] + 1 : frame[0] + 1)]),
      ArrowLeft: () => go(times[frame[2] >= 1 ? frame[0] : frame[2] > 0 ? frame[0] : Math.max(0, frame[0] - 1)]),
      ArrowUp: () => zoom(0.9), ArrowDown: () => zoom(1.1),
      Home: () => go(times[0]), End: () => go(times[frames - 1]),
      r: () => lookFrom("oblique"), o: () => { choose("layout", state.layout === "overlay" ? "split" : "overlay"); remember(); },
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
    redraw();
  });
  canvas.addEventListener("webglcontextlost", () => giveUp("The graphics card dropped the 3D view; reload the page to get it back."));
  new ResizeObserver(redraw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readTheme(); redraw(); });
  // Paper is light. Of this canvas browsers print what it showed last; a copy is painted anew.
  const copy = document.createElement("canvas");
  copy.style.cssText = "position: absolute; inset: 0; width: 100%; height: 100%";
  matchMedia("print").addEventListener("change", ({ matches }) => {
    readTheme();
    draw();
    copy.remove();
    if (!matches) return;
    Object.assign(copy, { width: canvas.width, height: canvas.height }).getContext("2d").drawImage(canvas, 0, 0);
    canvas.after(copy);
  });

  // "#t=1.2&layout=overlay&colour=strain&yaw=-0.6&pitch=0.3&zoom=1.5" opens the page in that state.
  const readAddress = () => {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const number = (name) => (wanted.has(name) && Number.isFinite(Number(wanted.get(name))) ? Number(wanted.get(name)) : null);
    if (number("t") !== null) seek(number("t"));
    if (number("yaw") !== null) state.yaw = number("yaw");
    if (number("pitch") !== null) state.pitch = number("pitch");
    // only a direction that is asked for changes the distance
    if (number("yaw") !== null || number("pitch") !== null) state.from = [state.yaw, state.pitch];
    if (number("zoom") > 0) state.distance = (radius * 3.3) / number("zoom");
    for (const name of ["layout", "colour"]) if (/^[a-z]+$/.test(wanted.get(name) ?? "")) choose(name, wanted.get(name));
    redraw();
  };
  addEventListener("hashchange", readAddress);
  readTheme();
  readAddress();
  draw();
})();
