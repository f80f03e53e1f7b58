// Shaders of the 3D view: vertex and fragment of each program by its name.
"use strict";
const SHADERS = (() => {
  const SURFACE = `
    uniform vec3 uEye, uLight; uniform vec4 uTint; uniform float uEdge, uDark; uniform int uMode;
    in vec3 vWorld; in vec2 vUv; in vec3 vColour; out vec4 oColour;
    void main() {
      if (uMode == 1) { oColour = vec4(0.0, 0.0, 0.0, uDark > 0.5 ? 0.38 : 0.2); return; }
      vec3 n = normalize(cross(dFdx(vWorld), dFdy(vWorld)));
      if (dot(n, uEye - vWorld) < 0.0) n = -n;
      float light = 0.42 + 0.24 * (0.5 + 0.5 * n.z) + 0.46 * max(dot(n, uLight), 0.0);
      vec3 base = mix(vColour, uTint.rgb, uTint.a);
      vec2 d = min(vUv, 1.0 - vUv) / max(fwidth(vUv), vec2(1e-6));
      float line = (1.0 - smoothstep(0.4, 1.4, min(d.x, d.y)));
      if (uMode == 2) { oColour = vec4(mix(base * light, uTint.rgb, line), max(0.16, line * 0.95)); return; }
      oColour = vec4(mix(base * light, base * light * 0.42, line * uEdge), 1.0);
    }`;
  const COMMON = `#version 300 es
    precision highp float; precision highp int; precision highp sampler2D; precision highp usampler2D;
    vec3 groupColour(float g) {
      int i = int(g + 0.5) % 8;
      vec3 c[8] = vec3[8](vec3(.784,.635,.42), vec3(.427,.576,.659), vec3(.725,.737,.722), vec3(.639,.502,.435), vec3(.549,.647,.498), vec3(.631,.573,.706), vec3(.816,.725,.627), vec3(.498,.541,.58));
      return c[i];
    }
    vec3 ramp(float s) {
      vec3 a = vec3(.839,.855,.863), b = vec3(.969,.776,.361), c = vec3(.91,.455,.231), d = vec3(.694,.165,.337), e = vec3(.239,.059,.369);
      return s < .2 ? mix(a,b,s/.2) : s < .45 ? mix(b,c,(s-.2)/.25) : s < .7 ? mix(c,d,(s-.45)/.25) : mix(d,e,min(1.,(s-.7)/.3));
    }`;
  const PLACE = `
    uniform mat4 uView; uniform vec4 uShadow; uniform int uMode; // uShadow: slope x, slope y, ground height
    vec4 place(vec3 p) {
      if (uMode == 1) { float h = max(p.z - uShadow.z, 0.0); p = vec3(p.xy - uShadow.xy * h, uShadow.z); }
      return uView * vec4(p, 1.0);
    }`;
  return {
    fe: [`${COMMON}${PLACE}
      layout(location=0) in uvec4 aNodes; layout(location=1) in uint aElement; layout(location=2) in float aBirth;
      uniform sampler2D uPositions, uElements; uniform float uTime, uStrain;
      out vec3 vWorld; out vec2 vUv; out vec3 vColour;
      void main() {
        int corner = int[6](0, 1, 2, 0, 2, 3)[gl_VertexID];
        int node = int(aNodes[corner]), e = int(aElement);
        vec4 element = texelFetch(uElements, ivec2(e & 1023, e >> 10), 0);
        vWorld = texelFetch(uPositions, ivec2(node & 1023, node >> 10), 0).xyz;
        vUv = vec2(corner == 1 || corner == 2, corner >= 2);
        vColour = uStrain > 0.5 ? ramp(element.z) : groupColour(element.y) * (1.0 + 0.07 * element.w);
        bool hidden = uTime <= aBirth || uTime > element.x;
        gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : place(vWorld);
      }`, `${COMMON}${SURFACE}`],
    box: [`${COMMON}${PLACE}
      layout(location=0) in vec3 aCorner; layout(location=1) in vec2 aUv;
      layout(location=2) in vec4 aRotation; layout(location=3) in vec3 aCentre; layout(location=4) in vec3 aHalf; layout(location=5) in vec2 aLook;
      uniform float uPlain;
      out vec3 vWorld; out vec2 vUv; out vec3 vColour;
      void main() {
        vec3 v = aCorner * aHalf, q = aRotation.yzw;
        vec3 t = 2.0 * cross(q, v);
        vWorld = aCentre + v + aRotation.x * t + cross(q, t);
        vUv = aUv;
        vColour = aLook.x < -0.5 ? vec3(.56,.58,.6) : uPlain > 0.5 ? vec3(.80,.815,.825) : groupColour(aLook.x) * (1.0 + 0.07 * aLook.y);
        gl_Position = place(vWorld);
      }`, `${COMMON}${SURFACE}`],
    floor: [`${COMMON}
      layout(location=0) in vec2 aCorner; uniform mat4 uView; uniform vec4 uArea; out vec2 vAt;
      void main() { vAt = aCorner * uArea.w + uArea.xy; gl_Position = uView * vec4(vAt, uArea.z, 1.0); }`,
      `${COMMON}
      in vec2 vAt; uniform vec4 uArea; uniform vec3 uFloor, uGrid; out vec4 oColour;
      float lines(vec2 p) { vec2 d = abs(fract(p - 0.5) - 0.5) / fwidth(p); return 1.0 - min(min(d.x, d.y), 1.0); }
      void main() {
        float fade = 1.0 - smoothstep(0.35, 1.0, distance(vAt, uArea.xy) / uArea.w);
        float wide = max(fwidth(vAt.x), fwidth(vAt.y));
        float line = max(lines(vAt) * 0.35 * (1.0 - smoothstep(0.1, 0.35, wide)), lines(vAt / 5.0) * 0.9);
        oColour = vec4(mix(uFloor, uGrid, line), fade);
      }`],
    point: [`${COMMON}
      layout(location=0) in vec3 aAt; layout(location=1) in vec2 aLook; uniform mat4 uView; uniform vec3 uEye; uniform float uRatio; flat out vec2 vLook;
      void main() { // lifted out of the member that it is in
        vLook = aLook; gl_Position = uView * vec4(aAt + 0.6 * normalize(uEye - aAt), 1.0); gl_PointSize = (aLook.x > 4.5 ? 21.0 : aLook.y > 0.5 ? 15.0 : aLook.x > 2.5 ? 11.0 : 9.0) * uRatio;
      }`,
      `${COMMON}
      flat in vec2 vLook; out vec4 oColour;
      void main() {
        vec2 p = 2.0 * gl_PointCoord - 1.0; p.y = -p.y;
        int kind = int(vLook.x + 0.5);
        float d = kind == 0 ? length(p) : kind == 1 ? max(abs(p.x) * 0.9 + (p.y * 0.5 - 0.05), -p.y - 0.15) + 0.35 : kind == 2 ? max(abs(p.x), abs(p.y)) + 0.12 : length(p) + 0.15;
        if (kind == 1) d = max(-p.y * 1.05 + 0.1, (p.y + abs(p.x) * 2.0) * 0.5 + 0.42);
        if (kind == 4) d = abs(p.x) + abs(p.y);
        if (kind == 5) d = length(p) / (0.76 + 0.24 * cos(8.0 * atan(p.y, p.x)));
        float w = fwidth(p.x) * 1.2;
        float inside = 1.0 - smoothstep(0.92 - w, 0.92, d);
        if (inside < 0.02) discard;
        vec3 c = vec3[6](vec3(.12,.62,.33), vec3(.82,.2,.17), vec3(.88,.63,0.), vec3(.5,.54,.58), vec3(.52,.42,.66), vec3(1.,.42,.05))[kind];
        // nothing in either, or nothing to compare with: an outline, thick enough for the few pixels that it has
        bool hollow = kind == 3 || kind == 4;
        float rim = smoothstep(hollow ? 0.3 : 0.66, (hollow ? 0.3 : 0.66) + w, d);
        if (hollow && rim < 0.02) discard;
        oColour = vec4(hollow ? c : mix(c, vec3(kind == 5 ? 0.12 : 1.0), rim), inside * (hollow ? rim : 1.0) * (vLook.y > 0.5 ? 1.0 : 0.85));
      }`],
  };
})();
