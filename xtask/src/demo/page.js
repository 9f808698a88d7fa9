// Where a spectrogram's picture has its plot, as shares of its width.
const plot = { from: 78 / 1360, width: 1164 / 1360 };
const shareAt = (event, picture) => Math.max(0, Math.min(1, (event.offsetX / picture.clientWidth - plot.from) / plot.width));
const put = (line, share) => { line.style.left = 100 * (plot.from + plot.width * share) + '%'; };

// The rows: one at a time; one that starts while another of its length plays goes on where that was.
const rows = [...document.querySelectorAll('.row')];
let stopPair = () => {};
for (const row of rows) {
  const audio = row.querySelector('audio'), picture = row.querySelector('.picture'), line = picture.querySelector('i');
  const draw = () => {
    put(line, audio.currentTime / audio.duration || 0);
    if (!audio.paused) requestAnimationFrame(draw);
  };
  const known = async () => {
    if (audio.duration > 0) return;
    await new Promise(ready => {
      audio.addEventListener('loadedmetadata', ready, { once: true });
      audio.preload = 'metadata';
      audio.load();
    });
  };
  audio.onplay = () => {
    stopPair();
    for (const other of rows) {
      const sound = other.querySelector('audio');
      if (other === row || sound.paused) continue;
      if (other.dataset.ms === row.dataset.ms) audio.currentTime = sound.currentTime;
      sound.pause();
    }
    for (const other of document.querySelectorAll('.playing')) other.classList.remove('playing');
    row.classList.add('playing');
    draw();
  };
  audio.onseeked = draw;
  picture.onclick = async event => {
    const share = shareAt(event, picture);
    await known();
    // Before it plays, so that it does not take over where another was.
    for (const other of rows) if (other !== row) other.querySelector('audio').pause();
    audio.currentTime = share * audio.duration;
    audio.play();
  };
}

// The pair: both sounds run through one clock, and only what is heard changes.
{
  const box = document.getElementById('pair'), button = box.querySelector('.play');
  const sides = [...box.querySelectorAll('.side')].map(side => ({
    side,
    line: side.querySelector('i'),
    picture: side.querySelector('.picture'),
    data: side.querySelector('script').textContent,
  }));
  let context, began = 0, at = 0, heard = 1, isPlaying = false;
  const length = () => Math.max(...sides.map(side => side.buffer.duration));
  const position = () => isPlaying ? (at + context.currentTime - began) % length() : at;
  const load = async () => {
    if (context) return;
    context = new AudioContext();
    for (const side of sides) {
      const bytes = Uint8Array.from(atob(side.data), letter => letter.charCodeAt(0));
      side.buffer = await context.decodeAudioData(bytes.buffer);
      side.gain = context.createGain();
      side.gain.connect(context.destination);
    }
  };
  const hear = number => {
    heard = number;
    sides.forEach((side, n) => {
      side.side.classList.toggle('on', n === heard);
      side.side.querySelector('button').setAttribute('aria-pressed', n === heard);
      // Some milliseconds, so that switching does not click.
      if (side.gain) side.gain.gain.setTargetAtTime(n === heard ? 1 : 0, context.currentTime, 0.006);
    });
  };
  const draw = () => {
    sides.forEach(side => put(side.line, side.buffer ? position() / length() : 0));
    if (isPlaying) requestAnimationFrame(draw);
  };
  const stop = () => {
    if (!isPlaying) return;
    at = position();
    isPlaying = false;
    for (const side of sides) side.source.stop();
    box.classList.remove('playing');
    button.textContent = 'Play';
  };
  const start = async from => {
    await load();
    await context.resume();
    stop();
    for (const row of rows) row.querySelector('audio').pause();
    for (const other of document.querySelectorAll('.playing')) other.classList.remove('playing');
    at = from ?? at;
    began = context.currentTime + 0.02;
    for (const side of sides) {
      side.source = context.createBufferSource();
      side.source.buffer = side.buffer;
      side.source.loop = true;
      side.source.loopEnd = length();
      side.source.connect(side.gain);
      side.source.start(began, Math.min(at, side.buffer.duration));
    }
    isPlaying = true;
    hear(heard);
    box.classList.add('playing');
    button.textContent = 'Pause';
    draw();
  };
  stopPair = stop;
  button.onclick = () => isPlaying ? stop() : start();
  sides.forEach((side, number) => {
    side.side.querySelector('button').onclick = () => { hear(number); if (!isPlaying) start(); };
    side.picture.onclick = async event => {
      const share = shareAt(event, side.picture);
      await load();
      hear(number);
      start(share * length());
    };
  });
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '1' || event.key === '2') hear(Number(event.key) - 1);
  });
  hear(heard);
}
