% SPDX-License-Identifier: MIT
function download(session, path, file, what, limit)
%DOWNLOAD Downloads path from the daemon's page to a file, completely or not at all. limit: timeout without an answer [s].
  status = session.brief_status();
  page = coopdyn.internal.url_here(session.address, char(status.http));
  if isempty(page)
    coopdyn.internal.fail(5, 'the daemon was started with --no-http, so there are no pictures and no files');
  end
  url = [regexprep(page, '/$', '') path];
  part = [file '.part'];
  cleanup = onCleanup(@() remove(part));
  try
    seat = session.address.seat;
    more = weboptions('Timeout', limit);
    if ~isempty(seat)
      more.HeaderFields = {'Authorization', ['Bearer ' seat ':' session.address.pin]};
    end
    if ~coopdyn.internal.is_octave()
      websave(part, url, more);
    elseif isempty(seat)
      [~, ok, message] = urlwrite(url, part);
      if ~ok
        coopdyn.internal.raise('coopdyn:not_possible', message);
      end
    else  % Octave has no websave, and urlwrite no headers
      save_bytes(part, webread(url, more));
    end
  catch cause
    coopdyn.internal.fail(5, ['no ' what ' from ' url ': ' strtrim(cause.message)]);
  end
  [ok, message] = movefile(part, file, 'f');
  if ~ok
    coopdyn.internal.fail(5, ['cannot write ' file ': ' message]);
  end
end

function save_bytes(file, bytes)
  f = fopen(file, 'w');
  if f < 0 || fwrite(f, uint8(bytes)) < numel(bytes) || fclose(f) ~= 0
    coopdyn.internal.raise('coopdyn:not_possible', ['cannot write ' file]);
  end
end

function remove(part)
  if exist(part, 'file') == 2
    delete(part);
  end
end
