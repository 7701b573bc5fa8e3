//! `serve`: the link of a camera on a port of this PC, for programs in other languages and on
//! other PCs.

use std::io::{self, ErrorKind, Write};
use std::net::{SocketAddr, TcpListener};
use std::time::{Duration, Instant};

use fmc_output::interruption::Interruption;

use crate::cli::ServeArgs;
use crate::device::port::{Port, TcpPort};
use crate::device::served::ServedCamera;
use crate::failure::{Failure, note};

/// Longest wait for bytes of either side before the other is looked at.
const TURN: Duration = Duration::from_millis(1);

/// The same while nobody is connected.
const IDLE: Duration = Duration::from_millis(20);

/// A program that has been silent for so long gives way to another: it may have gone without a
/// word, as where its computer has lost its supply.
const SILENT_FOR: Duration = Duration::from_secs(10);

/// Bytes taken in one turn.
const BUFFER_BYTES: usize = 4096;

/// A program that is connected.
struct Client {
    port: TcpPort,
    /// Time when it last said something.
    heard: Instant,
}

pub(super) fn run(args: &ServeArgs) -> Result<(), Failure> {
    // Whoever cannot be reached needs no camera.
    let listener = listen(args.listen)?;
    let mut camera = args.device.open_served()?;
    let address = listener
        .local_addr()
        .map_err(|error| refused(args.listen, &error))?;
    let interruption = Interruption::listen()
        .map_err(|error| Failure::device_or_io(format!("no signal can be caught: {error}")))?;
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "tcp:{address}")
        .and_then(|()| stdout.flush())
        .map_err(|error| Failure::writing("standard output", &error))?;
    if !address.ip().is_loopback() {
        note(
            "note: whoever reaches this port may command the camera; 127.0.0.1 serves this computer alone",
        );
    }
    if address.ip().is_unspecified() {
        note(format_args!(
            "note: for other computers it is tcp:HOST:{}, HOST being the name or an address of this one",
            address.port()
        ));
    }
    let mut client = None;
    while !interruption.is_asked() {
        accept(&listener, &mut client)?;
        match exchange(&mut camera, &mut client) {
            // Ctrl-C ends QEMU, too.
            Err(_) if interruption.is_asked() => break,
            exchanged => exchanged?,
        }
    }
    Ok(())
}

fn listen(address: SocketAddr) -> Result<TcpListener, Failure> {
    let listener = TcpListener::bind(address).map_err(|error| refused(address, &error))?;
    let patient = listener.set_nonblocking(true);
    patient.map_err(|error| refused(address, &error))?;
    Ok(listener)
}

fn refused(address: SocketAddr, error: &io::Error) -> Failure {
    let why = match error.kind() {
        ErrorKind::AddrInUse => "another program has this port".to_owned(),
        ErrorKind::AddrNotAvailable => "this computer does not have this address".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    };
    Failure::device_or_io(format!("--listen {address}: {why}"))
        .with_help("port 0 takes a free one, which is printed")
}

/// Takes a connection; while there is one that is not silent, another is closed.
fn accept(listener: &TcpListener, client: &mut Option<Client>) -> Result<(), Failure> {
    match listener.accept() {
        Ok((_, from))
            if client
                .as_ref()
                .is_some_and(|client| client.heard.elapsed() < SILENT_FOR) =>
        {
            note(format_args!(
                "{from}: closed, as another program is connected"
            ));
        }
        Ok((stream, from)) => match TcpPort::new(stream) {
            Ok(port) => {
                if client.is_some() {
                    disconnect(client);
                }
                note(format_args!("{from}: connected"));
                *client = Some(Client {
                    port,
                    heard: Instant::now(),
                });
            }
            Err(error) => note(format_args!("{from}: {error}")),
        },
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::WouldBlock | ErrorKind::Interrupted | ErrorKind::ConnectionAborted
            ) => {}
        Err(error) => {
            return Err(Failure::device_or_io(format!(
                "no connection can be taken: {error}"
            )));
        }
    }
    Ok(())
}

/// Passes on what has come from either side. A connection that ends leaves the camera as it is;
/// what the camera says while nobody is connected is not kept.
fn exchange(camera: &mut ServedCamera, client: &mut Option<Client>) -> Result<(), Failure> {
    let mut buffer = [0; BUFFER_BYTES];
    if let Some(Client { port, heard }) = client {
        match port.receive(&mut buffer, Instant::now() + TURN) {
            Ok(0) => {}
            Ok(count) => {
                *heard = Instant::now();
                let bytes = buffer.get(..count).unwrap_or_default();
                match camera.port().send(bytes) {
                    // Whoever asked asks again.
                    Err(error) if error.kind() == ErrorKind::TimedOut => {
                        note("the camera takes nothing: a message to it is lost");
                    }
                    sent => sent.map_err(|error| camera.explain(&error))?,
                }
            }
            Err(_) => disconnect(client),
        }
    }
    let wait = if client.is_some() { TURN } else { IDLE };
    let received = camera.port().receive(&mut buffer, Instant::now() + wait);
    let count = received.map_err(|error| camera.explain(&error))?;
    let bytes = buffer.get(..count).unwrap_or_default();
    if let Some(Client { port, .. }) = client
        && port.send(bytes).is_err()
    {
        disconnect(client);
    }
    Ok(())
}

fn disconnect(client: &mut Option<Client>) {
    *client = None;
    note("disconnected");
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::net::TcpStream;

    use super::*;
    use crate::device::DeviceName;
    use crate::device::qemu::QemuOptions;

    /// Connects another program.
    fn connect(listener: &TcpListener, client: &mut Option<Client>) -> TcpStream {
        let stream = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let within = Some(Duration::from_secs(5));
        stream.set_read_timeout(within).unwrap();
        accept(listener, client).unwrap();
        stream
    }

    /// Returns `true` if the other end has closed a connection.
    fn is_closed(mut stream: &TcpStream) -> bool {
        stream.read(&mut [0; 8]).unwrap() == 0
    }

    fn become_silent(client: &mut Option<Client>) {
        client.as_mut().unwrap().heard = Instant::now().checked_sub(SILENT_FOR).unwrap();
    }

    #[test]
    fn program_that_has_gone_without_a_word_gives_way_and_one_that_speaks_does_not() {
        let listener = listen("127.0.0.1:0".parse().unwrap()).unwrap();
        listener.set_nonblocking(false).unwrap();
        let mut camera = ServedCamera::open(&DeviceName::Sil, &QemuOptions::default()).unwrap();
        let mut client = None;
        let mut first = connect(&listener, &mut client);
        assert!(is_closed(&connect(&listener, &mut client)));

        become_silent(&mut client);
        first.write_all(&[0]).unwrap();
        let until = Instant::now() + Duration::from_secs(5);
        while client.as_ref().unwrap().heard.elapsed() >= SILENT_FOR {
            assert!(Instant::now() < until, "nothing arrives");
            exchange(&mut camera, &mut client).unwrap();
        }
        assert!(is_closed(&connect(&listener, &mut client)));

        become_silent(&mut client);
        let mut second = connect(&listener, &mut client);
        assert!(is_closed(&first));
        client.as_mut().unwrap().port.send(b"answer").unwrap();
        let mut answer = [0; 6];
        second.read_exact(&mut answer).unwrap();
        assert_eq!(&answer, b"answer");
    }
}
