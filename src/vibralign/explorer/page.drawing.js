// The drawing of the part on its springs over the slot, to scale; pure functions of what they draw.

/**
 * @typedef {{x: number, y: number, tilt: number, time: number, [name: string]: number}} Frame
 * @typedef {(x: number, y: number) => [number, number]} Place
 */

const COLOURS = {
  ink: "#1b1b1b", faint: "#6e6e6e", base: "#d9d4cc", part: "#a9cbe8", edge: "#0072B2",
  normal: "#D55E00", friction: "#009E73", holder: "#e9e9e9",
};
const CLOSED = 1; // a contact that presses
const PRESSED = 1, RUNNING = 2, STILL = 3; // numbers of starts (physics/approach.py)

/** Return what the supporting contact does, in words. @param {Frame} frame */
function contactWords(frame) {
  const support = frame.mode_face === CLOSED || frame.mode_corner === CLOSED;
  const words = [];
  if (frame.mode_in_slot && support) words.push(frame.mode_support_slip === 0 ? "sticks to the slot's right side" : "slides on the slot's right side");
  else if (support) words.push(frame.mode_support_slip === 0 ? "sticks on the edge" : frame.mode_support_slip < 0 ? "slides to the left" : "slides to the right");
  else words.push(frame.mode_dropped ? "falls into the slot" : "in flight");
  if (frame.mode_side === CLOSED || frame.mode_wall === CLOSED) words.push("touches the slot's left side");
  return words.join(", ");
}

/** Return the kind of contact: "sticks", "slides" or "flies". @param {Frame} frame */
function contactKind(frame) {
  const support = frame.mode_face === CLOSED || frame.mode_corner === CLOSED;
  if (!support && frame.mode_side !== CLOSED && frame.mode_wall !== CLOSED) return "flies";
  return (support ? frame.mode_support_slip : frame.mode_side_slip) === 0 ? "sticks" : "slides";
}

/**
 * Return centre and tilt as drawn: the part touches its edge at the same place with an exaggerated tilt.
 * @param {Frame} frame @param {any} device @param {number} exaggeration
 */
function drawnPose(frame, device, exaggeration) {
  const { x, y, tilt } = frame;
  if (exaggeration === 1) return { x, y, tilt };
  const edge = (frame.mode_edge || 1) * device.slot_half_width;
  const [sine, cosine] = [Math.sin(tilt), Math.cos(tilt)];
  const along = (edge - x) * cosine - y * sine, axis = -(edge - x) * sine - y * cosine;
  const drawn = Math.max(-1.2, Math.min(1.2, tilt * exaggeration));
  const [s, c] = [Math.sin(drawn), Math.cos(drawn)];
  return { x: edge - along * c + axis * s, y: -along * s - axis * c, tilt: drawn };
}

/** Draw a line through points. @param {CanvasRenderingContext2D} g @param {...[number, number]} points */
function line(g, ...points) {
  g.beginPath();
  for (const each of points) g.lineTo(...each);
  g.stroke();
}

/** @param {CanvasRenderingContext2D} g @param {[number, number]} from @param {[number, number]} to @param {string} colour */
function arrow(g, from, to, colour) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (length < 1) return;
  const [ux, uy] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length], head = Math.min(9, length);
  g.strokeStyle = g.fillStyle = colour;
  g.lineWidth = 2.5;
  line(g, from, [to[0] - ux * head * 0.7, to[1] - uy * head * 0.7]);
  g.beginPath();
  g.moveTo(...to);
  g.lineTo(to[0] - ux * head - uy * head * 0.5, to[1] - uy * head + ux * head * 0.5);
  g.lineTo(to[0] - ux * head + uy * head * 0.5, to[1] - uy * head - ux * head * 0.5);
  g.fill();
}

/** @param {CanvasRenderingContext2D} g @param {[number, number]} from @param {[number, number]} to */
function spring(g, from, to) {
  const turns = 6, [dx, dy] = [to[0] - from[0], to[1] - from[1]], length = Math.hypot(dx, dy) || 1;
  const [nx, ny] = [(-dy / length) * 5, (dx / length) * 5];
  const zigzag = Array.from({ length: 2 * turns + 1 }, (_, k) => {
    const at = 0.15 + (0.7 * (k + 0.5)) / (2 * turns + 1), side = k % 2 ? 1 : -1;
    return /** @type {[number, number]} */ ([from[0] + dx * at + nx * side, from[1] + dy * at + ny * side]);
  });
  line(g, from, ...zigzag, to);
}

/** @param {CanvasRenderingContext2D} g @param {Place} place @param {{x: number, y: number, tilt: number}} pose @param {any} device */
function outline(g, place, pose, device) {
  const [s, c] = [Math.sin(pose.tilt), Math.cos(pose.tilt)], a = device.half_width, b = device.half_height;
  const w = a + device.peg_chamfer, low = device.peg_chamfer - b;
  g.beginPath();
  for (const [u, v] of [[-a, -b], [a, -b], [w, low], [w, b], [-w, b], [-w, low]]) g.lineTo(...place(pose.x + u * c - v * s, pose.y + u * s + v * c));
  g.closePath();
}

/** Draw the base with its slot, whose mouth a chamfer widens. @param {CanvasRenderingContext2D} g @param {Place} place @param {any} device @param {number[]} box */
function drawBase(g, place, { slot_half_width: mouth, hole_chamfer: chamfer }, [left, top, width, height]) {
  const slot = mouth - chamfer, [edge, ground] = place(slot, 0), [other] = place(-slot, 0);
  g.fillStyle = COLOURS.base;
  g.strokeStyle = COLOURS.ink;
  g.lineWidth = 1.5;
  for (const [from, to, lip] of [[left, other, other], [edge, left + width, edge]]) {
    g.fillRect(from, ground, to - from, top + height - ground);
    line(g, [from === lip ? left + width : left, ground], [lip, ground], [lip, top + height]);
  }
  for (const side of chamfer ? [-1, 1] : []) {
    g.fillStyle = "#ffffff";
    g.beginPath();
    for (const at of [place(side * mouth, 0), place(side * slot, 0), place(side * slot, -chamfer)]) g.lineTo(...at);
    g.fill();
    line(g, place(side * mouth, 0), place(side * slot, -chamfer));
  }
  g.strokeStyle = COLOURS.faint;
  g.lineWidth = 0.75;
  g.setLineDash([6, 3, 1, 3]);
  line(g, place(0, 1e3), place(0, -1e3));
  g.setLineDash([]);
}

/** Mark the misalignment: the distance of the axes at the mouth of the slot. @param {CanvasRenderingContext2D} g @param {Place} place @param {any} pose @param {any} device */
function drawMisalignment(g, place, pose, device) {
  const [s, c] = [Math.sin(pose.tilt), Math.cos(pose.tilt)], b = device.half_height;
  const middle = pose.x + b * s, [, y] = place(0, -0.25 * device.half_width);
  const [from, to] = [place(0, 0)[0], place(middle, 0)[0]];
  g.strokeStyle = g.fillStyle = COLOURS.faint;
  g.lineWidth = 0.75;
  g.setLineDash([6, 3, 1, 3]);
  line(g, place(pose.x - b * s, pose.y + b * c), place(middle + 0.1 * b * s, pose.y - 1.1 * b * c));
  g.setLineDash([]);
  line(g, [from, y], [to, y]);
  for (const end of [from, to]) line(g, [end, y - 4], [end, y + 4]);
  g.font = "12px system-ui, sans-serif";
  g.fillText("misalignment", Math.max(from, to) + 6, y + 4);
}

/** Draw the contact forces of a frame as arrows. @param {CanvasRenderingContext2D} g @param {Place} place @param {Frame} frame @param {any} device @param {any} pose @param {number} scale */
function drawForces(g, place, frame, device, pose, scale) {
  const [s, c] = [Math.sin(pose.tilt), Math.cos(pose.tilt)];
  const edge = (frame.mode_edge || 1) * device.slot_half_width;
  const push = (/** @type {number[]} */ at, /** @type {number[]} */ way, /** @type {number} */ force, /** @type {string} */ colour) => {
    const [x, y] = place(at[0], at[1]);
    arrow(g, [x, y], [x + way[0] * force * scale, y - way[1] * force * scale], colour);
  };
  /** Return place, normal and tangent of the contact on a side of the slot. @param {number} side 1 right, -1 left @param {boolean} onEdge */
  const onSide = (side, onEdge) => {
    if (onEdge) return { at: [side * device.slot_half_width, 0], normal: [-side * c, -side * s], tangent: [side * s, -side * c] };
    const depth = pose.y + side * device.half_width * s - device.half_height * c;
    return { at: [side * device.slot_half_width, depth], normal: [-side, 0], tangent: [0, -side] };
  };
  /** @param {{at: number[], normal: number[], tangent: number[]}} contact @param {number} load @param {number} friction */
  const pushBoth = ({ at, normal, tangent }, load, friction) => {
    push(at, normal, Math.max(load, 0), COLOURS.normal);
    push(at, tangent, friction, COLOURS.friction);
  };
  if (frame.mode_face === CLOSED || frame.mode_corner === CLOSED) {
    const onFace = frame.mode_face === CLOSED;
    const corner = [pose.x + (frame.mode_edge || 1) * device.half_width * c + device.half_height * s, 0];
    const below = onFace ? { at: [edge, 0], normal: [-s, c], tangent: [c, s] } : { at: corner, normal: [0, 1], tangent: [1, 0] };
    pushBoth(frame.mode_in_slot ? onSide(1, onFace) : below, frame.at_support_load, frame.at_support_friction);
  }
  if (frame.mode_side === CLOSED || frame.mode_wall === CLOSED) pushBoth(onSide(-1, frame.mode_side === CLOSED), frame.at_side_load, frame.at_side_friction);
}

/**
 * Draw one frame: the whole part on its springs at the left, the slot enlarged at the right.
 * @param {CanvasRenderingContext2D} g @param {number} width @param {number} height
 * @param {Frame} frame @param {any} device parameters, dimensionless @param {number} exaggeration of the tilt
 */
function drawScene(g, width, height, frame, device, exaggeration) {
  g.fillStyle = "#ffffff";
  g.fillRect(0, 0, width, height);
  const whole = Math.round(width * 0.4), a = device.half_width, b = device.half_height;
  const tall = 2 * b + 3.2 * Math.max(a, 0.3 * b), scale = Math.min((height - 20) / (tall + a), (whole - 10) / (6 * a));
  const near = Math.min((height - 10) / (2.6 * a), (width - whole - 10) / (3.4 * a));
  const push = (0.22 * height) / Math.max(1, device.force_shown);
  for (const [left, wide, unit, below, springs] of /** @type {[number, number, number, number, boolean][]} */ ([
    [0, whole, scale, 1.1 * a * scale, true],
    [whole + 6, width - whole - 6, near, Math.min(0.42 * height, 1.1 * a * near), false],
  ])) {
    g.save();
    g.beginPath();
    g.rect(left, 0, wide, height);
    g.clip();
    /** @type {Place} */
    const place = (x, y) => [left + wide / 2 + unit * x, height - below - unit * y];
    drawBase(g, place, device, [left, 0, wide, height]);
    const pose = drawnPose(frame, device, exaggeration);
    if (springs) drawHolder(g, place, frame, device, pose, unit, tall, [left, wide]);
    outline(g, place, pose, device);
    g.fillStyle = COLOURS.part;
    g.globalAlpha = 0.85;
    g.fill();
    g.globalAlpha = 1;
    g.strokeStyle = COLOURS.edge;
    g.lineWidth = 2;
    g.stroke();
    if (springs) {
      g.fillStyle = COLOURS.ink;
      g.beginPath();
      g.arc(...place(pose.x, pose.y), 3, 0, 7);
      g.fill();
    } else {
      drawForces(g, place, frame, device, pose, push);
      if (!frame.mode_dropped) drawMisalignment(g, place, pose, device);
    }
    g.restore();
  }
  g.strokeStyle = COLOURS.faint;
  g.lineWidth = 1;
  g.strokeRect(whole + 6.5, 0.5, width - whole - 7, height - 1);
  g.fillStyle = COLOURS.faint;
  g.font = "12px system-ui, sans-serif";
  g.fillText("to scale", 6, height - 6);
  g.fillText(exaggeration === 1 ? "enlarged" : `enlarged; tilt × ${exaggeration}`, whole + 14, height - 8);
}

/**
 * Return the holder's swing, and its height over its last place, at a time of a track; see physics/approach.py.
 * @param {Track} track @param {any} device @param {number} start number of the start
 */
function holderOf(track, device, start) {
  const { frequency, phase, axial_damping: damping, approach_speed: speed, press_force: press } = device;
  const runs = start !== STILL, lowered = start === RUNNING || start === STILL;
  const real = 1 - frequency ** 2, imaginary = damping * frequency;
  const hangs = runs ? (Math.sin(phase) * real - Math.cos(phase) * imaginary) / (real ** 2 + imaginary ** 2) : 0;
  const rest = Number.isNaN(device.rest_y) ? device.half_height : device.rest_y;
  const first = lowered ? track.columns.y[0] + hangs - (rest - press + damping * speed) : 0;
  return (/** @type {number} */ time) => ({
    swing: runs ? Math.sin(frequency * time + phase) : time < track.zero ? 0 : Math.sin(frequency * (time - track.zero) + phase),
    lack: lowered ? Math.max(first - speed * time, 0) : 0,
  });
}

/** Draw the holder, which vibrates, and the springs between it and the part. @param {CanvasRenderingContext2D} g @param {Place} place @param {Frame} frame @param {any} device @param {any} pose @param {number} unit @param {number} tall @param {number[]} span */
function drawHolder(g, place, frame, device, pose, unit, tall, [left, wide]) {
  const a = device.half_width, { swing, lack } = device.holder(frame.time);
  const plate = tall - 0.4 * a + (lack - swing) * Math.min(1, 0.6 * a);
  const [s, c] = [Math.sin(pose.tilt), Math.cos(pose.tilt)], b = device.half_height;
  const top = place(pose.x - b * s, pose.y + b * c), [, y] = place(0, plate);
  g.strokeStyle = COLOURS.faint;
  g.lineWidth = 1.25;
  spring(g, [top[0], y], top);
  const [middle, height] = place(pose.x - a * c, pose.y - a * s), wall = left + 10;
  spring(g, [wall, height], [middle, height]);
  g.fillStyle = COLOURS.holder;
  g.strokeStyle = COLOURS.ink;
  g.fillRect(left + 6, y - 10, wide - 12, 10);
  g.strokeRect(left + 6, y - 10, wide - 12, 10);
  g.lineWidth = 2;
  line(g, [wall, y], [wall, height + 0.6 * a * unit]);
}
