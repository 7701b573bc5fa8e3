//! The link.

use fmc_camera::io::link::{
    digest,
    frame::{Frame, FrameReceiver},
    message::{Answer, Grid, Identity, Request},
    station::Station,
};

/// Keeps the public functions of `fmc_camera::io`.
pub(crate) fn keep() {
    keep![
        Frame::bytes,
        FrameReceiver::new,
        FrameReceiver::receive,
        Identity::new,
        Grid::points,
        Request::write,
        Request::read,
        Answer::write,
        Answer::read,
        digest::of_grid,
        digest::of_record,
        Station::new,
        Station::receive,
        Station::to_send,
        Station::sent,
        Station::count_overrun,
        Station::counters,
    ];
}
